#include "scenarios/imu_delivery.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace locsim::scenarios {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

Stamp ms(int milliseconds) {
  return Stamp{Duration{1'000'000LL * milliseconds}};
}

std::vector<ImuSample> samples_at(std::initializer_list<int> milliseconds) {
  std::vector<ImuSample> samples;
  for (const int t : milliseconds) samples.push_back({.time = ms(t)});
  return samples;
}

std::vector<int> times(const std::vector<DeliveredImu>& delivered) {
  std::vector<int> out;
  for (const DeliveredImu& d : delivered) {
    out.push_back(static_cast<int>(d.sample.time.time_since_epoch() / Duration{1'000'000}));
  }
  return out;
}

TEST(ImuDelivery, IsAtOnceWithoutFaults) {
  ImuDelivery delivery{sim::Faults()};
  const auto arrived = delivery.deliver(samples_at({5, 10}), ms(10));
  EXPECT_THAT(times(arrived), ElementsAre(5, 10));
  EXPECT_EQ(arrived[1].at, ms(10));
}

TEST(ImuDelivery, HoldsSamplesOfTheFaultBackAndLetsLaterOnesOvertake) {
  const sim::Faults faults({{.at_s = 0.02, .for_s = 0.02, .kind = sim::ImuLate{.delay_s = 0.03}}});
  ImuDelivery delivery(faults);
  EXPECT_THAT(times(delivery.deliver(samples_at({10, 20}), ms(20))), ElementsAre(10));
  EXPECT_THAT(times(delivery.deliver(samples_at({30}), ms(30))), IsEmpty());
  // 40 is taken when the fault is over; 20 and 30 are due at 50 and 60.
  EXPECT_THAT(times(delivery.deliver(samples_at({40}), ms(40))), ElementsAre(40));
  EXPECT_THAT(times(delivery.deliver(samples_at({50}), ms(50))), ElementsAre(20, 50));
  const auto last = delivery.deliver(samples_at({60, 70}), ms(70));
  EXPECT_THAT(times(last), ElementsAre(30, 60, 70));
  EXPECT_EQ(last[0].at, ms(60));
}

}  // namespace
}  // namespace locsim::scenarios
