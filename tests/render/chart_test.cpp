#include "render/chart.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/error.h"

namespace locsim::render {
namespace {

const Rect area{20.0, 20.0, 760.0, 360.0};

/// 0…10 s; ramps from 0 to 8 at 5 s and stays.
ChartPanel ramp() {
  ChartPanel panel;
  panel.title = "Speed";
  panel.y_label = "speed [m/s]";
  panel.series.push_back({"", {0.0, 5.0, 10.0}, {0.0, 8.0, 8.0}, palette::crimson, 5.0});
  return panel;
}

Image drawn(const ChartPanel& panel, const Scale& time) {
  Image image(800, 400);
  draw_chart(image, Typography(), area, panel, time, {});
  return image;
}

Color at(const Image& image, const Vector2d& p) {
  return image.at(static_cast<int>(p.x()), static_cast<int>(p.y()));
}

TEST(Chart, LinePassesThroughItsValuesPixels) {
  const ChartPanel panel = ramp();
  const Scale time{0.0, 10.0, false};
  const ChartFrame frame = lay_out_chart(Typography(), area, panel, time, {});
  const Image image = drawn(panel, time);
  EXPECT_EQ(at(image, frame.pixel(2.5, 4.0)), palette::crimson);
  EXPECT_EQ(at(image, frame.pixel(7.5, 8.0)), palette::crimson);
  EXPECT_NE(at(image, frame.pixel(7.5, 4.0)), palette::crimson);
  EXPECT_NEAR(frame.pixel(5.0, 0.0).x(), frame.plot.center().x(), 1e-9);
  EXPECT_NEAR(frame.pixel(5.0, frame.value.low).y(), frame.plot.bottom(), 1e-9);
}

TEST(Chart, ValueThatIsNoNumberInterruptsTheLine) {
  ChartPanel panel = ramp();
  panel.y = Scale{0.0, 10.0, false};
  panel.series[0].time_s = {0.0, 3.0, 5.0, 7.0, 10.0};
  panel.series[0].values = {4.0, 4.0, std::numeric_limits<double>::quiet_NaN(), 4.0, 8.0};
  const Scale time{0.0, 10.0, false};
  const ChartFrame frame = lay_out_chart(Typography(), area, panel, time, {});
  const Image image = drawn(panel, time);
  EXPECT_EQ(at(image, frame.pixel(1.5, 4.0)), palette::crimson);
  EXPECT_NE(at(image, frame.pixel(5.0, 4.0)), palette::crimson);
}

TEST(Chart, BandEventAndStateLieAtTheirTimes) {
  ChartPanel panel = ramp();
  const Color sand{200, 180, 140};
  const Color pink{220, 120, 160};
  const Color teal{20, 120, 120};
  panel.bands.push_back({"", {4.0, 6.0}, {2.0, 2.0}, {4.0, 4.0}, sand});
  panel.events.push_back({8.0, 9.0, "outage", pink});
  panel.states.push_back({0.0, 4.0, "tracking", teal});
  const Scale time{0.0, 10.0, false};
  const ChartFrame frame = lay_out_chart(Typography(), area, panel, time, {});
  const Image image = drawn(panel, time);
  EXPECT_EQ(at(image, frame.pixel(5.3, 3.1)), sand);
  EXPECT_NE(at(image, frame.pixel(5.3, 4.4)), sand);
  EXPECT_NE(at(image, frame.pixel(3.7, 3.1)), sand);
  EXPECT_EQ(at(image, frame.pixel(8.5, 3.0)), pink);
  EXPECT_NE(at(image, frame.pixel(7.7, 3.0)), pink);
  const double strip_y = frame.plot.bottom() + 9.0;
  EXPECT_EQ(at(image, {frame.pixel(2.0, 0.0).x(), strip_y}), teal);
  EXPECT_EQ(at(image, {frame.pixel(5.0, 0.0).x(), strip_y}), palette::paper);
}

TEST(Chart, PlotWithoutValuesSaysSo) {
  ChartPanel panel;
  panel.empty_note = "no estimate";
  const Image with_note = drawn(panel, {0.0, 10.0, false});
  panel.empty_note.clear();
  EXPECT_FALSE(with_note == drawn(panel, {0.0, 10.0, false}));
}

TEST(Chart, AxesAreLabelled) {
  ChartPanel panel = ramp();
  const Image image = drawn(panel, {0.0, 10.0, false});
  const ChartFrame frame = lay_out_chart(Typography(), area, panel, {0.0, 10.0, false}, {});
  const auto ink_in = [&](const Rect& rect) {
    int count = 0;
    for (int y = static_cast<int>(rect.y); y < rect.bottom(); ++y) {
      for (int x = static_cast<int>(rect.x); x < rect.right(); ++x) {
        count += image.at(x, y).r < 140 ? 1 : 0;
      }
    }
    return count;
  };
  EXPECT_GT(ink_in({area.x, frame.plot.y, 22.0, frame.plot.height}), 50) << "name of the y axis";
  EXPECT_GT(ink_in({area.x + 30.0, frame.plot.y, frame.plot.x - area.x - 32.0, frame.plot.height}),
            50)
      << "values";
  EXPECT_GT(ink_in({frame.plot.x, frame.plot.bottom() + 2.0, frame.plot.width, 40.0}), 100)
      << "times";
}

TEST(ChartColumn, PanelsShareTheirTimeAxis) {
  ChartPanel shorter = ramp();
  ChartPanel longer = ramp();
  longer.series[0].time_s.back() = 20.0;
  const std::array panels{shorter, longer};
  EXPECT_DOUBLE_EQ(time_scale(panels).high, 20.0);
  const Image image = draw_chart_column(panels, "Simulated beside logged", 1000, 700);
  ASSERT_EQ(image.width(), 1000);
  // Lines of both panels: the upper one ends in the middle, the lower goes through.
  int left = 0;
  int right = 0;
  for (int y = 0; y < 350; ++y) {
    for (int x = 0; x < 1000; ++x) {
      if (image.at(x, y) == palette::crimson) ++(x < 540 ? left : right);
    }
  }
  EXPECT_GT(left, 200);
  EXPECT_EQ(right, 0);
  EXPECT_TRUE(draw_chart_column(panels, "Simulated beside logged", 1000, 700) == image);
}

TEST(ChartColumn, TooManyPanelsForThePictureAreAnInputError) {
  const std::vector<ChartPanel> panels(8, ramp());
  EXPECT_THROW(static_cast<void>(draw_chart_column(panels, "", 800, 600)), InputError);
  EXPECT_EQ(draw_chart_column({}, "empty").height(), 1200);
}

}  // namespace
}  // namespace locsim::render
