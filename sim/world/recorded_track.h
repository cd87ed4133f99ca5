#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "core/geodesy.h"
#include "core/pose.h"

namespace locsim::sim {

/// A logged drive in the map frame.
struct RecordedTrack {
  /// The middle of the track's extent, at its lowest height.
  GeodeticPoint origin;
  struct Sample {
    /// From the first sample [s].
    double time_s = 0.0;
    /// Of the antenna (CSV) or of what the poses are of (TUM) [m].
    Vector3d position = Vector3d::Zero();
    /// Horizontal.
    double speed_m_s = 0.0;
    /// Of the motion, from East counter-clockwise [rad]; holds its last value at rest.
    double course_rad = 0.0;
    /// Horizontal standard deviation that the position is to count with [m].
    double sigma_m = 0.01;
  };
  std::vector<Sample> samples;
  /// The file, for messages.
  std::string source;
};

/// Reads a drive, in one of two formats told apart by the first line:
/// - CSV with a header that names at least t_gps_s, latitude_deg, longitude_deg, height_m,
///   velocity_north_m_s, velocity_east_m_s; quality (1: fixed; others count a tenth) and
///   sigma_north_m, sigma_east_m are used where present;
/// - TUM, `t x y z qx qy qz qw` a line in metres of any East-North-Up frame: its middle is moved to
///   `tum_origin`, speed and course come from the positions.
/// Throws InputError naming file and line: not readable, a column missing, a line cut short, not a
/// number, out of range, time not rising, shorter than 50 m, a vehicle heading against its motion.
[[nodiscard]] RecordedTrack load_recorded_track(const std::filesystem::path& path,
                                                const GeodeticPoint& tum_origin = {});

}  // namespace locsim::sim
