#include "scenarios/gnss_delivery.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <vector>

#include "tests/sim/gnss/gnss_rig.h"

namespace locsim::scenarios {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

Stamp ms(int milliseconds) {
  return Stamp{Duration{1'000'000LL * milliseconds}};
}

// Of the epoch at `at_ms`, heard `after_ms` later.
sim::GnssOutput output(int at_ms, int after_ms) {
  sim::GnssOutput output{.delivered = ms(at_ms + after_ms)};
  output.fix.time = output.raw.time = ms(at_ms);
  return output;
}

std::vector<int> times(const std::vector<sim::GnssOutput>& outputs) {
  std::vector<int> all;
  for (const sim::GnssOutput& o : outputs) {
    EXPECT_EQ(o.raw.time, o.fix.time);
    all.push_back(static_cast<int>(o.fix.time.time_since_epoch() / Duration{1'000'000}));
  }
  return all;
}

TEST(GnssDelivery, HoldsEachOutputBackUntilItIsDueAndGivesItOnce) {
  GnssDelivery delivery;
  EXPECT_THAT(delivery.deliver({output(200, 100)}, ms(200)), IsEmpty());
  EXPECT_THAT(delivery.deliver({}, ms(299)), IsEmpty());
  const auto arrived = delivery.deliver({}, ms(300));
  EXPECT_THAT(times(arrived), ElementsAre(200));
  EXPECT_EQ(arrived[0].delivered, ms(300));
  EXPECT_THAT(delivery.deliver({}, ms(1000)), IsEmpty());
}

TEST(GnssDelivery, LateOnesAreOvertakenByThoseAfterThem) {
  GnssDelivery delivery;
  EXPECT_THAT(
      times(delivery.deliver({output(200, 1100), output(400, 1100), output(600, 100)}, ms(600))),
      IsEmpty());
  EXPECT_THAT(times(delivery.deliver({output(800, 100)}, ms(900))), ElementsAre(600, 800));
  EXPECT_THAT(times(delivery.deliver({output(1200, 100)}, ms(1299))), IsEmpty());
  // Two at the same instant come in the order of their epochs.
  EXPECT_THAT(times(delivery.deliver({output(1400, 100)}, ms(1500))),
              ElementsAre(200, 1200, 400, 1400));
}

TEST(GnssDelivery, HowTimeIsCutMakesNoDifference) {
  std::vector<sim::GnssOutput> all;
  for (int k = 0; k < 40; ++k) all.push_back(output(100 * k, k % 7 == 3 ? 450 : 70));
  GnssDelivery at_once;
  const std::vector<int> whole = times(at_once.deliver(all, ms(10'000)));
  ASSERT_EQ(whole.size(), all.size());
  EXPECT_FALSE(std::ranges::is_sorted(whole));

  GnssDelivery step_by_step;
  std::vector<int> sliced;
  std::size_t next = 0;
  for (int now = 0; now <= 10'000; now += 10) {
    std::vector<sim::GnssOutput> fresh;
    while (next < all.size() && all[next].fix.time <= ms(now)) fresh.push_back(all[next++]);
    for (const int t : times(step_by_step.deliver(fresh, ms(now)))) sliced.push_back(t);
  }
  EXPECT_EQ(sliced, whole);
}

// A receiver at 5 Hz with 0.1 s of latency whose epochs from 1 s on are half a second late for a
// second.
TEST(GnssDelivery, TheReceiversLatencyAndItsFaultMakeTheDelay) {
  const sim::Faults faults({{.at_s = 1.0, .for_s = 1.0, .kind = sim::GnssLate{.delay_s = 0.5}}});
  const sim::GnssSpec spec = sim::flawless_receiver();
  ASSERT_EQ(spec.latency_s, 0.1);
  const auto outputs = sim::outputs_of(
      spec, sim::open_world(), sim::standing_still(3.0, std::chrono::milliseconds(10)), 1, faults);
  ASSERT_EQ(outputs.size(), 15U);
  GnssDelivery delivery;
  EXPECT_THAT(times(delivery.deliver(outputs, ms(1599))), ElementsAre(200, 400, 600, 800));
  EXPECT_THAT(times(delivery.deliver({}, ms(2099))), ElementsAre(1000, 1200, 1400));
  EXPECT_THAT(times(delivery.deliver({}, ms(2100))), ElementsAre(2000));
  EXPECT_THAT(times(delivery.deliver({}, ms(3100))),
              ElementsAre(1600, 2200, 1800, 2400, 2600, 2800, 3000));
}

}  // namespace
}  // namespace locsim::scenarios
