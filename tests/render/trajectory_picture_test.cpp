#include "render/trajectory_picture.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/error.h"
#include "render/track_style.h"
#include "render/trajectory_layout.h"

namespace locsim::render {
namespace {

/// A flat world and a bend of 1.2 km; the estimate runs 30 m beside the truth, so that the two
/// lines do not touch, and claims errors that grow from 0 to 0.5 m.
class TrajectoryTest : public testing::Test {
 protected:
  TrajectoryTest() : materials_{{"grass", 0.4, {0.2F, 0.4F, 0.1F}}} {
    world_.add_quad({-500, -500, 0}, {2000, -500, 0}, {2000, 1500, 0}, {-500, 1500, 0}, 0);
    picture_.title = "first_drive";
    picture_.subtitle = {"icp"};
    picture_.meshes = {{&world_, materials_, {}}};
    for (int i = 0; i <= 600; ++i) {
      const double s = 2.0 * i;
      const Vector3d p(s, 150.0 * std::sin(s / 300.0), 0.0);
      picture_.truth.push_back(p);
      picture_.estimate.push_back(
          {p + Vector3d(0.0, 30.0, 0.0), i * 0.2, 0.5 * i / 600.0, 0.1, TrackState::tracking});
    }
    picture_.duration_s = 120.0;
  }

  [[nodiscard]] TrajectoryLayout layout() const {
    return lay_out_trajectory(picture_, typography_);
  }
  [[nodiscard]] static Color at(const Image& image, const Vector2d& p) {
    return image.at(static_cast<int>(p.x()), static_cast<int>(p.y()));
  }
  [[nodiscard]] static long count(const Image& image, Color color, const Rect& within) {
    long n = 0;
    for (int y = static_cast<int>(within.y); y < within.bottom(); ++y) {
      for (int x = static_cast<int>(within.x); x < within.right(); ++x) {
        n += image.at(x, y) == color ? 1 : 0;
      }
    }
    return n;
  }

  Typography typography_;
  std::vector<Material> materials_;
  TriangleMesh world_;
  TrajectoryPicture picture_;
};

TEST_F(TrajectoryTest, EstimateHasItsErrorsColourWhereItIs) {
  const Image image = draw_trajectory(picture_);
  const TrajectoryLayout where = layout();
  ASSERT_FALSE(where.error.logarithmic);
  for (const std::size_t i : {100U, 300U, 500U}) {
    const EstimatePoint& e = picture_.estimate[i];
    const Color seen = at(image, where.map.pixel(e.position));
    const Color expected = turbo(e.error_m / where.error.high);
    // The pixel's centre may lie a pixel from the point: 1/600 of the scale or so along the line,
    // and no channel changes by more than four times the scale's share of 255.
    EXPECT_NEAR(seen.r, expected.r, 4);
    EXPECT_NEAR(seen.g, expected.g, 4);
    EXPECT_NEAR(seen.b, expected.b, 4);
  }
  EXPECT_NE(at(image, where.map.pixel(picture_.estimate[100].position)),
            at(image, where.map.pixel(picture_.estimate[500].position)));
}

TEST_F(TrajectoryTest, TruthIsDarkAndOverTheEstimate) {
  for (EstimatePoint& e : picture_.estimate) e.position.y() -= 30.0;
  const Image image = draw_trajectory(picture_);
  const TrajectoryLayout where = layout();
  const Vector2d p = where.map.pixel(picture_.truth[300]);
  // A line 1.7 px wide: one of the three pixels across it is wholly dark or nearly.
  int darkest = 255;
  for (int dy = -1; dy <= 1; ++dy)
    darkest = std::min<int>(darkest, at(image, p + Vector2d(0, dy)).g);
  EXPECT_LT(darkest, 90);
}

TEST_F(TrajectoryTest, RimTellsAStateThatIsNotTracking) {
  for (std::size_t i = 200; i < 400; ++i) picture_.estimate[i].state = TrackState::lost;
  const Image image = draw_trajectory(picture_);
  const TrajectoryLayout where = layout();
  const auto rim_of = [&](std::size_t i) {
    const Vector2d p = where.map.pixel(picture_.estimate[i].position);
    const Vector2d along = (where.map.pixel(picture_.estimate[i + 1].position) -
                            where.map.pixel(picture_.estimate[i - 1].position))
                               .normalized();
    return at(image, p + 4.75 * Vector2d(-along.y(), along.x()));
  };
  EXPECT_EQ(rim_of(300), state_color(TrackState::lost));
  EXPECT_EQ(rim_of(100), palette::paper);
  const double strip_y = where.chart_frame.plot.bottom() + 9.0;
  const auto strip_at = [&](double time_s) {
    return at(image, {where.chart_frame.pixel(time_s, 0.1).x(), strip_y});
  };
  EXPECT_EQ(strip_at(60.0), state_color(TrackState::lost));
  EXPECT_EQ(strip_at(20.0), state_color(TrackState::tracking));
}

TEST_F(TrajectoryTest, FixBesideTheTrackIsADotOfItsOwn) {
  picture_.gnss = {picture_.truth[300] + Vector3d(0.0, -80.0, 0.0)};
  const Image image = draw_trajectory(picture_);
  EXPECT_EQ(at(image, layout().map.pixel(picture_.gnss[0])), palette::violet);
}

TEST_F(TrajectoryTest, ScaleBarIsAsLongInPixelsAsItsMetresOnTheMap) {
  const Image image = draw_trajectory(picture_);
  const TrajectoryLayout where = layout();
  // The border of the bar: one unbroken dark row at its top.
  const int y = static_cast<int>(where.bar_left.y()) + 1;
  int first = -1;
  int last = -1;
  for (int x = static_cast<int>(where.map_key.x) + 58; x < where.map_key.right(); ++x) {
    if (image.at(x, y) != palette::ink) continue;
    if (first < 0) first = x;
    last = x;
  }
  const Vector2d a = where.map.pixel({0.0, 0.0, 0.0});
  const Vector2d b = where.map.pixel({where.bar.length_m, 0.0, 0.0});
  // Both ends may lie within a pixel that is not wholly dark.
  EXPECT_NEAR(last - first + 1, (b - a).norm(), 2.0);
  EXPECT_GT(last - first, 60);
}

TEST_F(TrajectoryTest, KeyCoversNoTrack) {
  for (int turn = 0; turn < 12; ++turn) {
    TrajectoryPicture turned;
    const Eigen::AngleAxisd rotation(turn * 0.5, Vector3d::UnitZ());
    for (int i = 0; i < 900; ++i) {
      const double a = i * 0.01;
      turned.truth.push_back(rotation * Vector3d(60.0 * a * std::cos(a), 90.0 * std::sin(a), 0.0));
    }
    const TrajectoryLayout where = lay_out_trajectory(turned, typography_);
    for (const Vector3d& p : turned.truth) {
      EXPECT_FALSE(where.map_key.contains(where.map.pixel(p))) << turn;
      EXPECT_TRUE(where.map.panel.contains(where.map.pixel(p))) << turn;
    }
    EXPECT_TRUE(where.map.panel.contains(where.map_key));
  }
}

TEST_F(TrajectoryTest, RouteThroughAllFourCornersMakesRoomForTheKey) {
  TrajectoryPicture round;
  // As wide for its height as the highest map panel, so that every corner is driven through.
  const double width_m = 1400.0;
  const double height_m = 540.0;
  for (int i = 0; i <= 2000; ++i) {
    const double s = 2.0 * (width_m + height_m) * i / 2000.0;
    const double up = std::clamp(s - width_m, 0.0, height_m);
    const double down = std::clamp(s - 2.0 * width_m - height_m, 0.0, height_m);
    const double forth = std::clamp(s, 0.0, width_m);
    const double back = std::clamp(s - width_m - height_m, 0.0, width_m);
    round.truth.emplace_back(forth - back, up - down, 0.0);
  }
  const TrajectoryLayout where = lay_out_trajectory(round, typography_);
  for (const Vector3d& p : round.truth) {
    EXPECT_FALSE(where.map_key.contains(where.map.pixel(p)));
    EXPECT_TRUE(where.map.panel.contains(where.map.pixel(p)));
  }
  EXPECT_TRUE(where.map.panel.contains(where.map_key));
}

TEST_F(TrajectoryTest, ErrorIsDrawnAtItsPixelsInTheChart) {
  const Image image = draw_trajectory(picture_);
  const TrajectoryLayout where = layout();
  const ChartFrame& chart = where.chart_frame;
  EXPECT_DOUBLE_EQ(chart.time.high, 120.0);
  // Error 0.25 m at 60 s, 0.1 m of claimed 3 σ = 0.3 m: a dark line over the band, white above it.
  const Vector2d p = chart.pixel(60.0, 0.25);
  int darkest = 255;
  for (int dy = -2; dy <= 2; ++dy)
    darkest = std::min<int>(darkest, at(image, p + Vector2d(0, dy)).r);
  EXPECT_LT(darkest, 100);
  const Color band = over(palette::paper, palette::blue_pale);
  EXPECT_EQ(at(image, chart.pixel(61.5, 0.15)), band);
  EXPECT_EQ(at(image, chart.pixel(61.5, 0.33)), palette::paper);
}

TEST_F(TrajectoryTest, TownIsShownInItsColoursButMuted) {
  const Image image = draw_trajectory(picture_);
  const TrajectoryLayout where = layout();
  const Color seen = at(image, where.map.pixel({600.0, -60.0, 0.0}));
  EXPECT_GT(seen.g, seen.r);
  EXPECT_GT(seen.g, seen.b);
  EXPECT_LT(seen.g - seen.b, 80);
  EXPECT_GT(seen.g, 150);
}

TEST_F(TrajectoryTest, WithoutEstimateThePictureSaysSoTwice) {
  picture_.estimate.clear();
  const Image image = draw_trajectory(picture_);
  const TrajectoryLayout where = layout();
  EXPECT_GT(count(image, palette::crimson, where.map.panel), 1000);
  EXPECT_GT(count(image, palette::ink_soft, where.chart_frame.plot), 200);
  EXPECT_EQ(where.chart.empty_note, "no estimate");
}

TEST_F(TrajectoryTest, EmptyAndSinglePointInputsMakePictures) {
  TrajectoryPicture nothing;
  nothing.width_px = 800;
  nothing.height_px = 600;
  const Image empty = draw_trajectory(nothing);
  EXPECT_GT(count(empty, palette::crimson, lay_out_trajectory(nothing, typography_).map.panel),
            300);
  TrajectoryPicture single = nothing;
  single.estimate.push_back({{5.0, 6.0, 7.0}, 0.0, 0.3, 0.1, TrackState::tracking});
  EXPECT_FALSE(draw_trajectory(single) == empty);
  single.truth = {{5.0, 6.0, 7.0}};
  single.gnss = {{5.5, 6.5, 7.0}};
  EXPECT_FALSE(draw_trajectory(single) == empty);
  const double nan = std::numeric_limits<double>::quiet_NaN();
  single.estimate.push_back({{nan, nan, nan}, 1.0, nan, nan, TrackState::lost});
  single.truth.emplace_back(nan, nan, nan);
  EXPECT_FALSE(draw_trajectory(single) == empty);
}

TEST_F(TrajectoryTest, LeapOfTheEstimateIsNotDrawnAsALine) {
  for (std::size_t i = 300; i < picture_.estimate.size(); ++i) {
    picture_.estimate[i].position.y() += 200.0;
  }
  const TrackLine line = track_line(picture_.estimate, layout().map, layout().error);
  EXPECT_EQ(line.points.size(), picture_.estimate.size() + 1);
  EXPECT_FALSE(line.points[300].allFinite());
}

TEST_F(TrajectoryTest, SameInputGivesTheSamePixelsTwice) {
  EXPECT_TRUE(draw_trajectory(picture_) == draw_trajectory(picture_));
}

TEST_F(TrajectoryTest, TooSmallAPictureIsAnInputError) {
  picture_.width_px = 300;
  EXPECT_THROW(static_cast<void>(draw_trajectory(picture_)), InputError);
}

}  // namespace
}  // namespace locsim::render
