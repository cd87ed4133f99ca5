#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "core/pose.h"
#include "core/time.h"
#include "localization/localizer.h"
#include "scenarios/scoring/scores.h"

namespace locsim::scenarios {

/// First lines of estimate.csv and gnss.csv. Sigmas of an estimate lie along the vehicle's axes,
/// those of a fix along east, north, up; x, y, z are in the map frame.
inline constexpr std::string_view kEstimateHeader =
    "t_s,x_m,y_m,z_m,qx,qy,qz,qw,vx_m_s,vy_m_s,vz_m_s,sigma_x_m,sigma_y_m,sigma_z_m,"
    "sigma_roll_deg,sigma_pitch_deg,sigma_yaw_deg,state";
inline constexpr std::string_view kGnssHeader =
    "t_s,valid,satellites,latitude_deg,longitude_deg,height_m,x_m,y_m,z_m,vx_m_s,vy_m_s,vz_m_s,"
    "sigma_x_m,sigma_y_m,sigma_z_m,sigma_vx_m_s,sigma_vy_m_s,sigma_vz_m_s,hdop,vdop,state";

/// What a run's folder tells about it.
struct RunFiles {
  struct TruthRow {
    Stamp time;
    Pose T_map_vehicle;
  };
  struct EstimateRow {
    Stamp time;
    Pose T_map_vehicle;
    Vector3d velocity_m_s = Vector3d::Zero();
    /// Along the vehicle's axes [m], [rad].
    Vector3d sigma_position_m = Vector3d::Zero();
    Vector3d sigma_rotation_rad = Vector3d::Zero();
    localization::State state = localization::State::initializing;
  };
  struct GnssRow {
    Stamp time;
    bool valid = false;
    int satellites = 0;
    /// Of the antenna, map frame; only where valid.
    Vector3d position_m = Vector3d::Zero();
    Vector3d sigma_m = Vector3d::Zero();
  };

  std::string scenario;
  std::uint64_t seed = 0;
  std::string localizer;
  bool passed = false;
  std::string hash;
  std::vector<Score> scores;
  std::vector<TruthRow> truth;
  std::vector<EstimateRow> estimates;
  std::vector<GnssRow> gnss;
};

/// Reads the folder of a run. Throws InputError naming the file, and the line where there is one,
/// if something is missing or not as a run writes it.
[[nodiscard]] RunFiles load_run(const std::filesystem::path& folder);

}  // namespace locsim::scenarios
