#include "scenarios/nmea.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/error.h"
#include "scenarios/gnss_text.h"

namespace locsim::scenarios {

namespace {

constexpr double kDegrees = 180.0 / std::numbers::pi;
constexpr double kKnots = 3600.0 / 1852.0;
constexpr double kSlowest_m_s = 0.1;
constexpr double kDilutionMost = 99.99;

std::string two_digits(std::int64_t value) {
  return whole_column(value, 2, '0');
}

std::string sentence(const std::string& body) {
  constexpr std::string_view kHex = "0123456789ABCDEF";
  unsigned sum = 0;
  for (const char character : body) sum ^= static_cast<unsigned char>(character);
  return "$" + body + "*" + kHex[sum >> 4U] + kHex[sum & 15U] + "\r\n";
}

std::string time_of_day(const CalendarTime& utc) {
  const std::int64_t hundredths = utc.rest / std::chrono::milliseconds(10);
  return two_digits(utc.hour) + two_digits(utc.minute) + two_digits(hundredths / 100) + "." +
         two_digits(hundredths % 100);
}

// Degrees and minutes in one number, comma, hemisphere.
std::string angle(double angle_rad, int degree_digits, std::string_view hemispheres) {
  constexpr std::int64_t kPerMinute = 1'000'000;
  const std::int64_t parts =
      std::llround(std::abs(angle_rad) * kDegrees * 60.0 * static_cast<double>(kPerMinute));
  const std::int64_t minutes = parts / kPerMinute;
  return whole_column(minutes / 60, degree_digits, '0') + two_digits(minutes % 60) + "." +
         whole_column(parts % kPerMinute, 6, '0') + "," + hemispheres[angle_rad < 0.0 ? 1 : 0];
}

std::string place(const GeodeticPoint& at) {
  if (!(std::abs(at.latitude_rad) <= std::numbers::pi / 2.0) || !std::isfinite(at.longitude_rad)) {
    throw InputError("fix at latitude " + std::to_string(at.latitude_rad * kDegrees) +
                     " deg, longitude " + std::to_string(at.longitude_rad * kDegrees) +
                     " deg: needs a latitude within [-90, 90] deg and a finite longitude");
  }
  const double longitude_rad = std::remainder(at.longitude_rad, 2.0 * std::numbers::pi);
  return angle(at.latitude_rad, 2, "NS") + "," + angle(longitude_rad, 3, "EW");
}

// From north over east, [0, 360).
std::string course(double east, double north) {
  const double from_north = std::atan2(east, north) * kDegrees;
  const std::string text = fixed_column(from_north < 0.0 ? from_north + 360.0 : from_north, 0, 2);
  return text == "360.00" ? "0.00" : text;
}

std::string gga(const GnssFix& fix, const std::string& time) {
  const std::string body = "GNGGA," + time + ",";
  const std::string used = two_digits(std::clamp(fix.satellites, 0, 99));
  if (!fix.valid) return sentence(body + ",,,,0," + used + ",,,M,,M,,");
  return sentence(body + place(fix.position) + ",1," + used + "," +
                  fixed_column(std::min(fix.hdop, kDilutionMost), 0, 2) + "," +
                  fixed_column(fix.position.height_m, 0, 3) + ",M,0.0,M,,");
}

std::string rmc(const GnssFix& fix, const std::string& time, const CalendarTime& utc) {
  const std::string body = "GNRMC," + time + ",";
  const std::string date = two_digits(utc.day) + two_digits(utc.month) + two_digits(utc.year % 100);
  if (!fix.valid) return sentence(body + "V,,,,,,," + date + ",,,N");
  const Vector3d& v = fix.velocity_enu_m_s;
  const double speed_m_s = std::hypot(v.x(), v.y());
  return sentence(body + "A," + place(fix.position) + "," + fixed_column(speed_m_s * kKnots, 0, 3) +
                  "," + (speed_m_s < kSlowest_m_s ? "" : course(v.x(), v.y())) + "," + date +
                  ",,,A");
}

std::string gst(const GnssFix& fix, const std::string& time) {
  const std::string body = "GNGST," + time + ",";
  if (!fix.valid) return sentence(body + ",,,,,,");
  const Matrix3d& covariance = fix.position_covariance_m2;
  const auto sigma = [](double variance) {
    return "," + fixed_column(std::sqrt(std::max(variance, 0.0)), 0, 3);
  };
  // Eigenvalues come in rising order.
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d> ellipse(covariance.topLeftCorner<2, 2>());
  const Eigen::Vector2d major = ellipse.eigenvectors().col(1);
  // An axis has no head: the half towards the east.
  const double side = major.x() < 0.0 ? -1.0 : 1.0;
  return sentence(body + sigma(ellipse.eigenvalues()[1]) + sigma(ellipse.eigenvalues()[0]) + "," +
                  course(side * major.x(), side * major.y()) + sigma(covariance(1, 1)) +
                  sigma(covariance(0, 0)) + sigma(covariance(2, 2)));
}

}  // namespace

std::string nmea(std::span<const GnssFix> fixes, sim::GpsTime start) {
  std::string text;
  for (const GnssFix& fix : fixes) {
    const sim::GpsTime at = rounded(start + fix.time.time_since_epoch() - leap_seconds(),
                                    std::chrono::milliseconds(10));
    const CalendarTime utc = calendar_time(at);
    const std::string time = time_of_day(utc);
    text += gga(fix, time) + rmc(fix, time, utc) + gst(fix, time);
  }
  return text;
}

}  // namespace locsim::scenarios
