#pragma once

#include <cstddef>
#include <filesystem>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "core/messages.h"
#include "sim/imu/rest_stretches.h"

namespace locsim::scenarios {

/// Columns of an IMU log, one of the two first and all others, in any order; a log may have more.
inline constexpr std::string_view kImuTimeGps = "t_gps_s";
inline constexpr std::string_view kImuTime = "t_s";
inline constexpr std::string_view kImuColumns[] = {"accel_x_m_s2", "accel_y_m_s2", "accel_z_m_s2",
                                                   "gyro_x_rad_s", "gyro_y_rad_s", "gyro_z_rad_s"};

/// A recording of an IMU.
struct ImuLog {
  /// The file, for messages.
  std::string source;
  /// The name of the time's column.
  std::string time_column{kImuTime};
  std::vector<ImuSample> samples;

  /// Samples per second within stretches without gaps.
  double rate_hz = 0.0;
  /// Shortest and longest interval that is not a gap [s].
  double shortest_interval_s = 0.0;
  double longest_interval_s = 0.0;

  /// An interval of more than one and a half of the median one.
  struct Gap {
    /// Position of the sample before it.
    std::size_t after = 0;
    double length_s = 0.0;
  };
  std::vector<Gap> gaps;

  [[nodiscard]] double duration_s() const;
  /// The samples between the gaps.
  [[nodiscard]] std::vector<sim::Stretch> without_gaps() const;
};

/// Reads a log: CSV, a header that names the columns, at least three samples; times to the
/// nanosecond. Empty lines and lines that begin with # are skipped. Throws InputError naming file,
/// line, column and value: not readable, a column missing or there twice, a line cut short, not a
/// number, a time that does not rise.
[[nodiscard]] ImuLog read_imu_log(const std::filesystem::path& file);

/// The log as text, as it is read; values to the bit.
[[nodiscard]] std::string imu_log_csv(std::span<const ImuSample> samples,
                                      std::string_view time_column = kImuTime);

/// Writes it under a temporary name beside `file`, then renames it. Throws InputError naming the
/// file where it cannot be written.
void write_imu_log(std::span<const ImuSample> samples, const std::filesystem::path& file,
                   std::string_view time_column = kImuTime);

}  // namespace locsim::scenarios
