#include <gtest/gtest.h>

#include <algorithm>

#include "tests/localization/dynamic_icp/trouble.h"

namespace locsim::localization {
namespace {

using namespace testing;

TEST(BadMessagesClock, AfterAScanFromTheFuture) {
  std::vector<Message> messages = first_seconds(8.0);
  const auto at = std::ranges::find_if(messages, [](const Message& m) {
    return std::holds_alternative<LidarScan>(m) && to_seconds(time_of(m)) > 2.5;
  });
  LidarScan wrong = std::get<LidarScan>(*at);
  wrong.start += std::chrono::seconds(3);
  wrong.end += std::chrono::seconds(3);
  messages.insert(at, wrong);
  // Until the clock has come there, and a second to find itself.
  expect_recovery(messages, kNothing, 7.2);
}

TEST(BadMessagesClock, AfterASampleOfAnotherHour) {
  std::vector<Message> messages = first_seconds(6.0);
  const auto at = std::ranges::find_if(messages, [](const Message& m) {
    return std::holds_alternative<ImuSample>(m) && to_seconds(time_of(m)) > 2.5;
  });
  ImuSample wrong = std::get<ImuSample>(*at);
  wrong.time += std::chrono::hours(1);
  messages.insert(at, wrong);
  expect_recovery(messages, kNothing, 5.0);
}

TEST(BadMessagesClock, AfterAClockThatJumped) {
  for (const int hours : {1, -1}) {
    SCOPED_TRACE(hours);
    std::vector<Message> messages = first_seconds(6.5);
    const auto move = [&](Stamp t) {
      return t + (t >= stamp_from_seconds(2.5) ? std::chrono::hours(hours) : std::chrono::hours(0));
    };
    for (Message& message : messages) {
      const Duration by = move(time_of(message)) - time_of(message);
      std::visit(
          [&](auto& m) {
            if constexpr (std::is_same_v<std::decay_t<decltype(m)>, LidarScan>) {
              m.start += by;
              m.end += by;
            } else {
              m.time += by;
            }
          },
          message);
    }
    const auto truth = [&](Stamp t) {
      const double s = to_seconds(t);
      const bool is_moved = hours > 0 ? s > 1800.0 : s < 0.0;
      return driven().pose(is_moved ? s - 3600.0 * hours : s);
    };
    // A second until it is believed, another to begin anew.
    expect_recovery(messages, {3.6, 3.7}, 5.8, truth);
  }
}

}  // namespace
}  // namespace locsim::localization
