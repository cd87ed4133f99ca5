#pragma once

#include <span>
#include <string>

#include "core/messages.h"
#include "sim/gnss/ionosphere.h"
#include "sim/gnss/signal_in_space.h"

namespace locsim::scenarios {

/// What the header of an observation file says of the station.
struct RinexHeader {
  /// At most 60 and 20 characters; longer ones are cut.
  std::string marker = "locsim";
  std::string receiver = "simulated";
  /// Where the antenna is at about the first epoch; the origin where that is not known.
  Vector3d approximate_ecef_m = Vector3d::Zero();
  /// Between epochs; 0 where not known.
  Duration interval{0};
};

/// RINEX 3.04 observation file of several systems: pseudorange, phase, Doppler and C/N0 of GPS and
/// GLONASS C/A, Galileo E1 C and BeiDou B1I. An epoch without observations leaves a gap,
/// as does one whose receiver time does not rise.
///
/// `start` is GPS time at Stamp{}. An epoch is dated by its `receiver_time`, to 100 ns, as RINEX
/// wants it: then the time of sending, date less pseudorange/c, is free of the receiver's clock
/// offset, and satellites are looked up where they were. (Dated by true time, 0.5 ms of offset
/// would move them by up to 0.4 m along the line of sight.)
///
/// What is missing is left blank: phase without lock, and what is zero or not finite. Slips set the
/// loss-of-lock indicator; signal strength is C/N0 in steps of 6 dB, 1…9. Throws InputError where a
/// value does not fit its column.
[[nodiscard]] std::string rinex_observations(const RinexHeader& header,
                                             std::span<const GnssEpoch> epochs, sim::GpsTime start);

/// RINEX 3.04 navigation file: the messages in their order, Klobuchar's coefficients as those of
/// GPS, leap seconds. Clocks are referred to toe (toc = toe); group delays are zero, satellites are
/// healthy, Galileo's data are I/NAV (data source 517). Times of transmission are nominal: toe less
/// 2 h for GPS, less a quarter of an hour for GLONASS, toe for the others.
///
/// Readers tell messages of a satellite apart by `issue`, and take Galileo's only after its toe.
/// Throws InputError where a toe is not at a whole second, or that of GLONASS not at a full quarter
/// of an hour UTC, to which readers round it.
[[nodiscard]] std::string rinex_navigation(std::span<const sim::BroadcastMessage> messages,
                                           const sim::KlobucharModel& ionosphere,
                                           sim::GpsTime start);

}  // namespace locsim::scenarios
