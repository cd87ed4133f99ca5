#include "core/hash.h"
#include "scenarios/results.h"

namespace locsim::scenarios {

namespace {

template <typename Matrix>
void add_matrix(Hash& hash, const Matrix& matrix) {
  for (Eigen::Index i = 0; i < matrix.size(); ++i) hash.add(matrix.reshaped()(i));
}

void add(Hash& hash, Stamp time) {
  hash.add(std::int64_t{time.time_since_epoch().count()});
}

void add(Hash& hash, const Pose& pose) {
  add_matrix(hash, pose.translation);
  add_matrix(hash, pose.rotation.coeffs());
}

void add(Hash& hash, const TruthSample& sample) {
  add(hash, sample.time);
  add(hash, sample.T_map_vehicle);
  add_matrix(hash, sample.velocity_m_s);
}

void add(Hash& hash, const localization::Estimate& estimate) {
  add(hash, estimate.time);
  add(hash, estimate.T_map_vehicle);
  add_matrix(hash, estimate.velocity_m_s);
  add_matrix(hash, estimate.covariance);
  add_matrix(hash, estimate.gyro_bias_rad_s);
  add_matrix(hash, estimate.accel_bias_m_s2);
  hash.add(static_cast<std::uint64_t>(estimate.state));
}

void add(Hash& hash, const GnssFix& fix) {
  add(hash, fix.time);
  hash.add(static_cast<std::uint64_t>(fix.valid));
  hash.add(static_cast<std::int64_t>(fix.satellites));
  if (!fix.valid) return;
  hash.add(fix.position.latitude_rad);
  hash.add(fix.position.longitude_rad);
  hash.add(fix.position.height_m);
  add_matrix(hash, fix.velocity_enu_m_s);
  add_matrix(hash, fix.position_covariance_m2);
  add_matrix(hash, fix.velocity_covariance_m2_s2);
}

void add(Hash& hash, const GnssEpoch& epoch) {
  add(hash, epoch.time);
  for (const GnssObservation& observation : epoch.observations) {
    hash.add(static_cast<std::uint64_t>(observation.satellite.system));
    hash.add(static_cast<std::int64_t>(observation.satellite.number));
    hash.add(observation.pseudorange_m);
    hash.add(observation.doppler_hz);
    hash.add(observation.cn0_db_hz);
    hash.add(observation.carrier_cycles);
  }
}

void add(Hash& hash, const Score& score) {
  hash.add_bytes(score.name.data(), score.name.size());
  hash.add(static_cast<std::uint64_t>(score.value.has_value()));
  hash.add(score.value.value_or(0.0));
}

template <typename Item>
void add_all(Hash& hash, const std::vector<Item>& items) {
  hash.add(static_cast<std::uint64_t>(items.size()));
  for (const Item& item : items) add(hash, item);
}

}  // namespace

std::string RunResult::hash() const {
  Hash hash;
  add_all(hash, truth);
  add_all(hash, estimates);
  add_all(hash, fixes);
  add_all(hash, epochs);
  add_all(hash, scores.scores);
  return hash.hex();
}

}  // namespace locsim::scenarios
