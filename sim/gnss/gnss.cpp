#include "sim/gnss/gnss.h"

#include "core/parameters.h"
#include "sim/sample_times.h"

namespace locsim::sim {

Gnss::Gnss(const GnssSpec& spec, const Vector3d& antenna_in_vehicle_m, const World& world,
           const RayScene& scene, const LocalFrame& frame, GpsTime start, std::uint64_t seed,
           const Faults& faults)
    : spec_((check_parameters(spec, "gnss"), spec)),
      frame_(frame),
      faults_(faults),
      receiver_(spec_, antenna_in_vehicle_m, world, scene, frame, start, seed, faults),
      navigation_(spec_.solution) {}

void Gnss::sample(const Trajectory& trajectory, Stamp from, Stamp to,
                  std::vector<GnssOutput>& out) {
  const SampleTimes times{.start = trajectory.start(), .period = spec_.period()};
  for (std::int64_t k = times.first_after(from); times[k] <= to; ++k) {
    GnssOutput output = epoch(trajectory, times, k);
    if (const GnssFrozen* frozen = faults_.active<GnssFrozen>(times[k]); frozen && last_) {
      output = *last_;
      if (frozen->new_stamps) {
        output.raw.receiver_time += times[k] - output.raw.time;
        output.fix.time = output.raw.time = times[k];
      }
    } else {
      last_ = output;
    }
    output.delivered = times[k] + spec_.latency();
    if (const GnssLate* late = faults_.active<GnssLate>(times[k])) {
      output.delivered += late->delay();
    }
    out.push_back(std::move(output));
  }
}

GnssOutput Gnss::epoch(const Trajectory& trajectory, const SampleTimes& times, std::int64_t k) {
  if (!believed_) {
    // It has been running: it knows where it is.
    believed_ = frame_.to_geodetic(receiver_.antenna(trajectory, times.start).position_map_m);
  }
  GnssOutput output;
  output.raw = receiver_.measure(trajectory, times, k, believed_);
  output.fix = navigation_.fix(output.raw);
  if (output.fix.valid) believed_ = output.fix.position;
  if (const GnssOverconfident* claim = faults_.active<GnssOverconfident>(times[k])) {
    const double factor = claim->sigma_factor * claim->sigma_factor;
    output.fix.position_covariance_m2 *= factor;
    output.fix.velocity_covariance_m2_s2 *= factor;
  }
  return output;
}

}  // namespace locsim::sim
