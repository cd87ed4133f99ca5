#include <array>
#include <chrono>
#include <initializer_list>
#include <variant>

#include "core/error.h"
#include "scenarios/gnss_text.h"
#include "scenarios/rinex.h"
#include "sim/gnss/constellation.h"

namespace locsim::scenarios {

namespace {

using std::chrono::minutes;
using std::chrono::seconds;

// BeiDou's time (BDT) starts at the beginning of 2006, then level with UTC.
constexpr int kBeidouFirstWeek = 1356;
constexpr Duration kBeidouBehindGps = seconds(14);

// Bits 0 and 2: I/NAV on E1-B and E5b-I; 9: clock of E5b and E1 (RINEX 3.04, table A8).
constexpr double kGalileoSources = 517.0;
// σ of the range as satellites claim it: lowest of GPS and BeiDou, usual of Galileo [m].
constexpr double kAccuracy_m = 2.0;
constexpr double kGalileoAccuracy_m = 3.12;
constexpr double kGpsFit_h = 4.0;

constexpr double kHealthy = 0.0;
constexpr double kSpare = 0.0;
constexpr double kGroupDelay_s = 0.0;

struct Epoch {
  sim::GpsTime time;
  double week = 0.0;
};
// In the time of the satellite's system.
Epoch in_own_time(const SatelliteId& satellite, sim::GpsTime gps) {
  switch (satellite.system) {
    case GnssSystem::beidou: {
      const sim::GpsTime bdt = gps - kBeidouBehindGps;
      return {bdt, static_cast<double>(bdt.week - kBeidouFirstWeek)};
    }
    case GnssSystem::glonass: {
      const sim::GpsTime utc = gps - leap_seconds();
      return {utc, static_cast<double>(utc.week)};
    }
    case GnssSystem::gps:
    case GnssSystem::galileo:
      break;
  }
  return {gps, static_cast<double>(gps.week)};
}

std::string number(double value) {
  return exponent_column(value, 19, 12);
}

std::string line(std::initializer_list<double> values) {
  std::string text = "    ";
  for (const double value : values) text += number(value);
  return text + "\n";
}

// Satellite, epoch and clock.
std::string first_line(const SatelliteId& satellite, sim::GpsTime own_time,
                       std::initializer_list<double> clock) {
  if (own_time.of_week % seconds(1) != Duration::zero()) {
    throw InputError("satellite " + satellite.name() + ": toe " +
                     std::to_string(to_seconds(own_time.of_week)) +
                     " s of the week needs to be a whole second");
  }
  const CalendarTime date = calendar_time(own_time);
  std::string text = satellite.name() + " " + whole_column(date.year, 4);
  for (const int part : {date.month, date.day, date.hour, date.minute})
    text += " " + whole_column(part, 2, '0');
  text += " " + whole_column(date.rest / seconds(1), 2, '0');
  for (const double value : clock) text += number(value);
  return text + "\n";
}

// What the lines of the three systems with Kepler's parameters do not share.
struct OwnFields {
  double sources = kSpare;
  double accuracy_m = kAccuracy_m;
  double last_of_health_line = kSpare;
  /// From toe.
  double sent_s = 0.0;
  double last = kSpare;
};

OwnFields own_fields(const sim::BroadcastMessage& message) {
  switch (message.id().system) {
    case GnssSystem::gps:
      return {.last_of_health_line = static_cast<double>(message.issue),
              .sent_s = -7200.0,
              .last = kGpsFit_h};
    case GnssSystem::galileo:
      return {.sources = kGalileoSources,
              .accuracy_m = kGalileoAccuracy_m,
              .last_of_health_line = kGroupDelay_s};
    case GnssSystem::beidou:
    case GnssSystem::glonass:
      break;
  }
  return {.last_of_health_line = kGroupDelay_s, .last = static_cast<double>(message.issue)};
}

std::string record(const sim::BroadcastMessage& message, const sim::KeplerEphemeris& e) {
  const Epoch toe = in_own_time(e.id, e.toe);
  const double toe_s = e.toe_of_system_week_s();
  const OwnFields own = own_fields(message);
  return first_line(e.id, toe.time, {message.af0_s, message.af1_s_s, message.af2_s_s2}) +
         line({static_cast<double>(message.issue), e.crs_m, e.mean_motion_excess_rad_s,
               e.mean_anomaly_rad}) +
         line({e.cuc_rad, e.eccentricity, e.cus_rad, e.root_of_semi_major_axis}) +
         line({toe_s, e.cic_rad, e.node_rad, e.cis_rad}) +
         line({e.inclination_rad, e.crc_m, e.perigee_rad, e.node_rate_rad_s}) +
         line({e.inclination_rate_rad_s, own.sources, toe.week, kSpare}) +
         line({own.accuracy_m, kHealthy, kGroupDelay_s, own.last_of_health_line}) +
         line({toe_s + own.sent_s, own.last});
}

std::string record(const sim::BroadcastMessage& message, const sim::GlonassEphemeris& e) {
  constexpr Duration kQuarter = minutes(15);
  const sim::GpsTime toe = in_own_time(e.id, e.toe).time;
  if (toe.of_week % kQuarter != Duration::zero()) {
    throw InputError("satellite " + e.id.name() + ": toe " +
                     std::to_string(to_seconds(toe.of_week)) +
                     " s of the week in UTC needs to be at a full quarter of an hour");
  }
  const double sent_s = to_seconds((toe - kQuarter).of_week);
  const std::array<double, 3> last{kHealthy, static_cast<double>(sim::glonass_channel(e.id.number)),
                                   0.0};
  std::string text = first_line(e.id, toe, {message.af0_s, message.af1_s_s, sent_s});
  for (int axis = 0; axis < 3; ++axis) {
    constexpr double kKilometre_m = 1000.0;
    text +=
        line({e.position_ecef_m[axis] / kKilometre_m, e.velocity_ecef_m_s[axis] / kKilometre_m,
              e.luni_solar_ecef_m_s2[axis] / kKilometre_m, last[static_cast<std::size_t>(axis)]});
  }
  return text;
}

std::string klobuchar_line(std::string_view name, const std::array<double, 4>& coefficients) {
  std::string content(name);
  content += " ";
  for (const double value : coefficients) content += exponent_column(value, 12, 4);
  return rinex_header_line(std::move(content), "IONOSPHERIC CORR");
}

}  // namespace

std::string rinex_navigation(std::span<const sim::BroadcastMessage> messages,
                             const sim::KlobucharModel& ionosphere, sim::GpsTime start) {
  std::string text = rinex_first_lines("N: GNSS NAV DATA", start);
  text += klobuchar_line("GPSA", ionosphere.alpha);
  text += klobuchar_line("GPSB", ionosphere.beta);
  text += rinex_header_line(whole_column(leap_seconds() / seconds(1), 6), "LEAP SECONDS");
  text += rinex_header_line("", "END OF HEADER");
  for (const sim::BroadcastMessage& message : messages) {
    text += std::visit([&](const auto& orbit) { return record(message, orbit); }, message.orbit);
  }
  return text;
}

}  // namespace locsim::scenarios
