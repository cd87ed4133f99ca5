#pragma once

#include <span>
#include <vector>

#include "core/messages.h"
#include "sim/gnss/gnss_receiver.h"

namespace locsim::scenarios {

/// What satellites told during a run, as navigation files hold it.
struct SatelliteBroadcast {
  /// Each message once, by time of its orbit, then by satellite.
  std::vector<sim::BroadcastMessage> messages;
  sim::KlobucharModel ionosphere;
};

/// Of every satellite in `epochs`, the messages that were in force; `start` is GPS time at Stamp{}.
[[nodiscard]] SatelliteBroadcast broadcast_of(const sim::GnssReceiver& receiver,
                                              std::span<const GnssEpoch> epochs,
                                              sim::GpsTime start);

}  // namespace locsim::scenarios
