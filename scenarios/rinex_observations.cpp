#include <algorithm>
#include <cmath>
#include <iterator>
#include <optional>
#include <set>
#include <vector>

#include "scenarios/gnss_text.h"
#include "scenarios/rinex.h"
#include "sim/gnss/constellation.h"

namespace locsim::scenarios {

namespace {

constexpr Duration kTick{100};

// Band and attribute of the one signal of a system (RINEX 3.04, tables 4 to 9).
std::string_view signal(GnssSystem system) {
  return system == GnssSystem::beidou ? "2I" : "1C";
}

std::string padded(std::string text, std::size_t columns) {
  text.resize(columns, ' ');
  return text;
}

char letter(const SatelliteId& satellite) {
  return satellite.name().front();
}

std::set<SatelliteId> satellites_of(std::span<const GnssEpoch> epochs) {
  std::set<SatelliteId> all;
  for (const GnssEpoch& epoch : epochs)
    for (const GnssObservation& seen : epoch.observations) all.insert(seen.satellite);
  return all;
}

sim::GpsTime date_of(const GnssEpoch& epoch, sim::GpsTime start) {
  return rounded(start + epoch.receiver_time.time_since_epoch(), kTick);
}

std::string first_time_line(std::span<const GnssEpoch> epochs, sim::GpsTime start) {
  const auto first = std::ranges::find_if(
      epochs, [](const GnssEpoch& epoch) { return !epoch.observations.empty(); });
  const CalendarTime date = calendar_time(first == epochs.end() ? start : date_of(*first, start));
  std::string content;
  for (const int part : {date.year, date.month, date.day, date.hour, date.minute})
    content += whole_column(part, 6);
  content += fixed_column(to_seconds(date.rest), 13, 7) + "     GPS";
  return rinex_header_line(std::move(content), "TIME OF FIRST OBS");
}

std::string system_lines(const std::set<SatelliteId>& satellites) {
  std::string types;
  std::string shifts;
  std::set<GnssSystem> written;
  for (const SatelliteId& satellite : satellites) {
    if (!written.insert(satellite.system).second) continue;
    const std::string code(signal(satellite.system));
    std::string line{letter(satellite)};
    line += "    4";
    for (const char* kind : {" C", " L", " D", " S"}) line += kind + code;
    types += rinex_header_line(std::move(line), "SYS / # / OBS TYPES");
    std::string shift{letter(satellite)};
    shift += " L" + code + "  0.00000";
    shifts += rinex_header_line(std::move(shift), "SYS / PHASE SHIFT");
  }
  return types + rinex_header_line("DBHZ", "SIGNAL STRENGTH UNIT") + shifts;
}

std::string glonass_lines(const std::set<SatelliteId>& satellites) {
  std::vector<SatelliteId> slots;
  std::ranges::copy_if(satellites, std::back_inserter(slots), [](const SatelliteId& satellite) {
    return satellite.system == GnssSystem::glonass;
  });
  constexpr std::size_t kOnALine = 8;
  std::string lines;
  std::string line = whole_column(static_cast<std::int64_t>(slots.size()), 3) + " ";
  for (std::size_t i = 0; i < slots.size(); ++i) {
    if (i > 0 && i % kOnALine == 0) {
      lines += rinex_header_line(std::move(line), "GLONASS SLOT / FRQ #");
      line = "    ";
    }
    line += slots[i].name() + " " + whole_column(sim::glonass_channel(slots[i].number), 2) + " ";
  }
  lines += rinex_header_line(std::move(line), "GLONASS SLOT / FRQ #");
  return lines + rinex_header_line(slots.empty() ? "" : " C1C    0.000", "GLONASS COD/PHS/BIS");
}

std::string header_text(const RinexHeader& header, std::span<const GnssEpoch> epochs,
                        sim::GpsTime start) {
  const std::set<SatelliteId> satellites = satellites_of(epochs);
  std::string position;
  for (const double part : header.approximate_ecef_m) position += fixed_column(part, 14, 4);
  std::string offset;
  for (int i = 0; i < 3; ++i) offset += fixed_column(0.0, 14, 4);

  std::string text = rinex_first_lines("OBSERVATION DATA", start);
  text += rinex_header_line(header.marker, "MARKER NAME");
  text += rinex_header_line("GROUND_CRAFT", "MARKER TYPE");
  text += rinex_header_line("", "OBSERVER / AGENCY");
  text += rinex_header_line(padded("", 20) + padded(header.receiver, 20), "REC # / TYPE / VERS");
  text += rinex_header_line("", "ANT # / TYPE");
  text += rinex_header_line(std::move(position), "APPROX POSITION XYZ");
  text += rinex_header_line(std::move(offset), "ANTENNA: DELTA H/E/N");
  text += system_lines(satellites);
  if (header.interval > Duration::zero())
    text += rinex_header_line(fixed_column(to_seconds(header.interval), 10, 3), "INTERVAL");
  text += first_time_line(epochs, start);
  text += glonass_lines(satellites);
  text +=
      rinex_header_line(whole_column(leap_seconds() / std::chrono::seconds(1), 6), "LEAP SECONDS");
  return text + rinex_header_line("", "END OF HEADER");
}

std::string field(double value, char lock, char strength) {
  if (!std::isfinite(value) || value == 0.0) return std::string(16, ' ');
  return fixed_column(value, 14, 3) + lock + strength;
}

std::string observation_line(const GnssObservation& seen) {
  const double cn0 = std::isfinite(seen.cn0_db_hz) ? seen.cn0_db_hz : 0.0;
  const char strength =
      cn0 > 0.0 ? static_cast<char>('0' + static_cast<int>(std::clamp(cn0 / 6.0, 1.0, 9.0))) : ' ';
  std::string line = seen.satellite.name();
  line += field(seen.pseudorange_m, ' ', strength);
  line +=
      field(seen.carrier_locked ? seen.carrier_cycles : 0.0, seen.slipped ? '1' : ' ', strength);
  line += field(seen.doppler_hz, ' ', ' ');
  line += field(cn0, ' ', ' ');
  line.erase(line.find_last_not_of(' ') + 1);
  return line + "\n";
}

std::string epoch_line(const GnssEpoch& epoch, sim::GpsTime start) {
  const CalendarTime date = calendar_time(date_of(epoch, start));
  std::string line = "> " + whole_column(date.year, 4);
  for (const int part : {date.month, date.day, date.hour, date.minute})
    line += " " + whole_column(part, 2, '0');
  line += fixed_column(to_seconds(date.rest), 11, 7) + "  0";
  return line + whole_column(static_cast<std::int64_t>(epoch.observations.size()), 3) + "\n";
}

}  // namespace

std::string rinex_observations(const RinexHeader& header, std::span<const GnssEpoch> epochs,
                               sim::GpsTime start) {
  std::string text = header_text(header, epochs, start);
  std::optional<Stamp> last;
  for (const GnssEpoch& epoch : epochs) {
    // A receiver that repeats itself, stamps and all, brings no new epoch.
    if (epoch.observations.empty() || (last && epoch.receiver_time <= *last)) continue;
    last = epoch.receiver_time;
    text += epoch_line(epoch, start);
    for (const GnssObservation& seen : epoch.observations) text += observation_line(seen);
  }
  return text;
}

}  // namespace locsim::scenarios
