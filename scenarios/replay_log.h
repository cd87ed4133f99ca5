#pragma once

#include <cstddef>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "core/messages.h"
#include "core/time.h"
#include "scenarios/imu_log.h"

namespace locsim::scenarios {

/// A recorded drive's files within its folder.
inline constexpr std::string_view kLoggedImu = "imu.csv";
inline constexpr std::string_view kLoggedGnss = "gnss.csv";

/// A recording of a GNSS receiver.
struct GnssLog {
  struct Entry {
    GnssFix fix;
    /// Good enough to score against: an integer-fixed carrier solution where the log has a column
    /// `quality`, any valid fix where it has none.
    bool reference = false;
  };

  /// The file, for messages.
  std::string source;
  /// The name of the time's column, t_gps_s or t_s.
  std::string time_column;
  std::vector<Entry> entries;
  /// From the time that a fix's velocity is true of to the fix's own stamp.
  Duration velocity_delay{0};
};

/// Reads a log of fixes: CSV, a header that names the columns, in any order, times to the
/// nanosecond. Two sets of columns are known:
/// - of a receiver: t_gps_s (or t_s), latitude_deg, longitude_deg, height_m, quality (RTKLIB's: 0
///   none, 1 fixed, 2 float, 3 SBAS, 4 differential, 5 single, 6 precise point), satellites,
///   sigma_north_m, sigma_east_m, sigma_up_m, velocity_north_m_s, velocity_east_m_s,
///   velocity_up_m_s, sigma_vn_m_s, sigma_ve_m_s, sigma_vu_m_s;
/// - of a run's folder, as RunResult is written.
/// Throws InputError naming file, line, column and value: not readable, a column missing, not a
/// number, out of its limits, a time that does not rise, no fix to score against.
[[nodiscard]] GnssLog read_gnss_log(const std::filesystem::path& file);

/// A drive's IMU and GNSS.
struct DriveLog {
  ImuLog imu;
  GnssLog gnss;

  /// Moves the fixes to the IMU's clock: `offset` is added to their stamps. Those outside of the
  /// IMU's record are dropped. Throws InputError where none to score against is left.
  void shift_gnss(Duration offset);
};

/// Reads imu.csv and gnss.csv of a folder. Throws InputError as the readers of the two, and where
/// the folder or one of them is missing, or their times are of different kinds or do not overlap.
[[nodiscard]] DriveLog read_drive_log(const std::filesystem::path& folder);

}  // namespace locsim::scenarios
