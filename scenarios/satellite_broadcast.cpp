#include "scenarios/satellite_broadcast.h"

#include <map>
#include <utility>

namespace locsim::scenarios {

SatelliteBroadcast broadcast_of(const sim::GnssReceiver& receiver,
                                std::span<const GnssEpoch> epochs, sim::GpsTime start) {
  std::map<std::pair<sim::GpsTime, SatelliteId>, sim::BroadcastMessage> messages;
  for (const GnssEpoch& epoch : epochs) {
    for (const GnssObservation& observation : epoch.observations) {
      const sim::BroadcastMessage message = receiver.signal_in_space().broadcast(
          observation.satellite, start + epoch.time.time_since_epoch());
      messages.try_emplace({message.toe(), observation.satellite}, message);
    }
  }
  SatelliteBroadcast broadcast{.ionosphere = receiver.ionosphere().broadcast()};
  for (auto& [key, message] : messages) broadcast.messages.push_back(std::move(message));
  return broadcast;
}

}  // namespace locsim::scenarios
