#include "scenarios/replay_log.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <initializer_list>
#include <numbers>

#include "core/error.h"
#include "scenarios/csv_reader.h"
#include "scenarios/text_io.h"

namespace locsim::scenarios {

namespace fs = std::filesystem;

namespace {

constexpr double kRadiansPerDegree = std::numbers::pi / 180.0;
constexpr int kFixedQuality = 1;
constexpr int kLastQuality = 6;

// East, north, up.
using Triple = std::array<std::size_t, 3>;

struct Columns {
  std::size_t time = 0;
  std::size_t latitude = 0;
  std::size_t longitude = 0;
  std::size_t height = 0;
  std::size_t satellites = 0;
  // Quality, or whether the fix is valid.
  std::size_t status = 0;
  bool has_quality = false;
  Triple sigma{};
  Triple velocity{};
  Triple sigma_velocity{};
};

// Finds columns, and says together which of them are missing.
class ColumnFinder {
 public:
  explicit ColumnFinder(const CsvReader& csv) : csv_(csv) {}

  std::size_t one(std::string_view name) {
    const auto column = csv_.find(name);
    if (!column) missing_ += " " + std::string(name);
    return column.value_or(0);
  }
  Triple three(std::string_view east, std::string_view north, std::string_view up) {
    return {one(east), one(north), one(up)};
  }
  void finish(std::string_view needed) const {
    if (missing_.empty()) return;
    csv_.fail("the header lacks" + missing_ + "; it must name " + std::string(needed) +
              ", in any order");
  }

 private:
  const CsvReader& csv_;
  std::string missing_;
};

Columns find_columns(const CsvReader& csv, std::string& time_column) {
  const bool gps = csv.find(kImuTimeGps).has_value();
  if (gps && csv.find(kImuTime)) csv.fail("the header names both t_gps_s and t_s; leave one");
  time_column = gps ? kImuTimeGps : kImuTime;
  ColumnFinder find(csv);
  Columns columns;
  columns.time = find.one(time_column);
  columns.latitude = find.one("latitude_deg");
  columns.longitude = find.one("longitude_deg");
  columns.height = find.one("height_m");
  columns.satellites = find.one("satellites");
  columns.has_quality = !csv.find("valid");
  if (columns.has_quality) {
    columns.status = find.one("quality");
    columns.sigma = find.three("sigma_east_m", "sigma_north_m", "sigma_up_m");
    columns.velocity = find.three("velocity_east_m_s", "velocity_north_m_s", "velocity_up_m_s");
    columns.sigma_velocity = find.three("sigma_ve_m_s", "sigma_vn_m_s", "sigma_vu_m_s");
    find.finish(
        "t_gps_s (or t_s), latitude_deg, longitude_deg, height_m, quality, satellites, "
        "sigma_north_m, sigma_east_m, sigma_up_m, velocity_north_m_s, velocity_east_m_s, "
        "velocity_up_m_s, sigma_vn_m_s, sigma_ve_m_s, sigma_vu_m_s");
  } else {
    columns.status = find.one("valid");
    columns.sigma = find.three("sigma_x_m", "sigma_y_m", "sigma_z_m");
    columns.velocity = find.three("vx_m_s", "vy_m_s", "vz_m_s");
    columns.sigma_velocity = find.three("sigma_vx_m_s", "sigma_vy_m_s", "sigma_vz_m_s");
    find.finish(
        "t_s, valid, satellites, latitude_deg, longitude_deg, height_m, vx_m_s, vy_m_s, vz_m_s, "
        "sigma_x_m, sigma_y_m, sigma_z_m, sigma_vx_m_s, sigma_vy_m_s, sigma_vz_m_s");
  }
  return columns;
}

int whole(const CsvReader& csv, std::size_t column, int most, const std::string& right) {
  const double value = csv.number(column);
  if (value != std::floor(value) || value < 0.0 || value > most) {
    csv.fail(column, "needs to be " + right);
  }
  return static_cast<int>(value);
}

double within(const CsvReader& csv, std::size_t column, double limit) {
  const double value = csv.number(column);
  if (std::abs(value) > limit) {
    const std::string most = std::to_string(static_cast<int>(limit));
    csv.fail(column, "needs to lie in -" + most + "..." + most);
  }
  return value;
}

Vector3d vector(const CsvReader& csv, const Triple& columns) {
  return {csv.number(columns[0]), csv.number(columns[1]), csv.number(columns[2])};
}

Matrix3d covariance(const CsvReader& csv, const Triple& columns) {
  const Vector3d sigma = vector(csv, columns);
  for (std::size_t i = 0; i < 3; ++i) {
    if (!(sigma[static_cast<Eigen::Index>(i)] > 0.0)) {
      csv.fail(columns[i], "needs to be above 0: a standard deviation");
    }
  }
  return sigma.cwiseAbs2().asDiagonal();
}

GnssLog::Entry read_entry(const CsvReader& csv, const Columns& columns) {
  GnssLog::Entry entry;
  GnssFix& fix = entry.fix;
  fix.time = csv.time(columns.time);
  fix.satellites = whole(csv, columns.satellites, 1000, "a count of satellites, 0 to 1000");
  const int status =
      columns.has_quality
          ? whole(csv, columns.status, kLastQuality,
                  "0 (none), 1 (fixed), 2 (float), 3 (SBAS), 4 (differential), 5 (single) or 6 "
                  "(precise point)")
          : whole(csv, columns.status, 1, "0 or 1");
  fix.valid = status != 0;
  if (!fix.valid) return entry;
  entry.reference = !columns.has_quality || status == kFixedQuality;
  fix.position = {.latitude_rad = within(csv, columns.latitude, 90.0) * kRadiansPerDegree,
                  .longitude_rad = within(csv, columns.longitude, 180.0) * kRadiansPerDegree,
                  .height_m = within(csv, columns.height, 100'000.0)};
  fix.velocity_enu_m_s = vector(csv, columns.velocity);
  fix.position_covariance_m2 = covariance(csv, columns.sigma);
  fix.velocity_covariance_m2_s2 = covariance(csv, columns.sigma_velocity);
  fix.state = FixState::three_dimensional;
  return entry;
}

std::string span_text(Stamp from, Stamp until) {
  return exact_seconds(from) + " to " + exact_seconds(until);
}

}  // namespace

GnssLog read_gnss_log(const fs::path& file) {
  CsvReader csv(file);
  GnssLog log;
  log.source = csv.source();
  const Columns columns = find_columns(csv, log.time_column);
  bool any_reference = false;
  while (csv.next()) {
    const GnssLog::Entry entry = read_entry(csv, columns);
    if (!log.entries.empty() && entry.fix.time <= log.entries.back().fix.time) {
      csv.fail(columns.time, "does not lie after " + exact_seconds(log.entries.back().fix.time) +
                                 " of the fix before; sort the log by time");
    }
    any_reference = any_reference || entry.reference;
    log.entries.push_back(entry);
  }
  if (!any_reference) {
    csv.fail(columns.has_quality ? "no fix has quality 1 (fixed), there is nothing to score against"
                                 : "no fix is valid, there is nothing to score against");
  }
  return log;
}

void DriveLog::shift_gnss(Duration offset) {
  for (GnssLog::Entry& entry : gnss.entries) entry.fix.time += offset;
  std::erase_if(gnss.entries, [&](const GnssLog::Entry& entry) {
    return entry.fix.time < imu.samples.front().time || entry.fix.time > imu.samples.back().time;
  });
  if (std::ranges::none_of(gnss.entries, &GnssLog::Entry::reference)) {
    throw InputError(gnss.source + ": shifted by " + exact_seconds(Stamp{offset}) +
                     " s, no fix to score against lies within the IMU's record; give another "
                     "offset");
  }
}

DriveLog read_drive_log(const fs::path& folder) {
  if (!fs::is_directory(folder)) {
    throw InputError(folder.string() + ": is no folder; needs one with " + std::string(kLoggedImu) +
                     " and " + std::string(kLoggedGnss));
  }
  DriveLog log{.imu = read_imu_log(folder / kLoggedImu),
               .gnss = read_gnss_log(folder / kLoggedGnss)};
  if (log.imu.time_column != log.gnss.time_column) {
    throw InputError(log.gnss.source + ": its times are " + log.gnss.time_column + ", those of " +
                     log.imu.source + " " + log.imu.time_column + "; both need the same clock");
  }
  const Stamp imu_from = log.imu.samples.front().time;
  const Stamp imu_until = log.imu.samples.back().time;
  const Stamp gnss_from = log.gnss.entries.front().fix.time;
  const Stamp gnss_until = log.gnss.entries.back().fix.time;
  if (gnss_until < imu_from || imu_until < gnss_from) {
    throw InputError(log.gnss.source + ": goes from " + span_text(gnss_from, gnss_until) +
                     " s, the IMU from " + span_text(imu_from, imu_until) +
                     " s; they need to be recorded at the same time");
  }
  return log;
}

}  // namespace locsim::scenarios
