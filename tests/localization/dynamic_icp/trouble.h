#pragma once

#include <functional>
#include <span>
#include <vector>

#include "tests/localization/dynamic_icp/simulated_messages.h"

namespace locsim::localization::testing {

inline const Drive& driven() {
  static const Drive drive{.start_x_m = -90.0, .standing_s = 1.0};
  return drive;
}

inline const std::vector<Message>& driven_record() {
  static const std::vector<Message> messages =
      record(Sensors(the_street(), driven(), make_rig()), 8.0);
  return messages;
}

inline std::vector<Message> first_seconds(double duration_s) {
  std::vector<Message> messages = driven_record();
  std::erase_if(messages, [&](const Message& m) { return to_seconds(time_of(m)) > duration_s; });
  return messages;
}

/// A stretch of the drive.
struct Span {
  double from_s = 0.0;
  double to_s = 0.0;
  [[nodiscard]] bool holds(double t) const { return t >= from_s && t < to_s; }
};
inline constexpr Span kTrouble{2.5, 3.2};
inline constexpr Span kNothing{};

/// What must hold of a run in which `kTrouble` is bad: sound throughout, tracking before it, never
/// `tracking` more than 2 m off, not tracking in `silent`, and tracking from `again_s` to the end.
inline void expect_recovery(
    std::span<const Message> messages, Span silent, double again_s,
    const std::function<Pose(Stamp)>& truth = [](Stamp t) {
      return driven().pose(to_seconds(t));
    }) {
  const auto localizer = make_dynamic_icp();
  int before = 0;
  int after = 0;
  double delivered_s = 0.0;
  State last = State::initializing;
  for (const Message& message : messages) {
    // Late ones come when those about them do.
    if (std::holds_alternative<ImuSample>(message)) delivered_s += 0.005;
    deliver(*localizer, message);
    const std::optional<Estimate> estimate = localizer->estimate();
    if (!estimate) continue;
    expect_sound(*estimate);
    const double t = 0.005 + delivered_s;
    last = estimate->state;
    if (::testing::Test::HasFailure()) FAIL() << "at " << t << " s";
    if (t < kTrouble.from_s) before += last == State::tracking ? 1 : 0;
    if (t > again_s) {
      ++after;
      ASSERT_EQ(last, State::tracking) << "at " << t << " s";
    }
    if (last != State::tracking) continue;
    ASSERT_LT(error_m(*estimate, truth(estimate->time)), 2.0) << "at " << t << " s";
    ASSERT_FALSE(silent.holds(t)) << "at " << t << " s";
  }
  EXPECT_GT(before, 200);
  EXPECT_GT(after, 20);
  EXPECT_EQ(last, State::tracking);
}

}  // namespace locsim::localization::testing
