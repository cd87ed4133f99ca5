#include "scenarios/results.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <limits>
#include <nlohmann/json.hpp>
#include <numbers>
#include <set>
#include <sstream>
#include <string>
#include <vector>

#include "core/error.h"
#include "scenarios/run_files.h"
#include "scenarios/yaml_parameters.h"
#include "sim/gnss/signal_in_space.h"
#include "tests/scenarios/drives.h"
#include "tests/scenarios/rinex_reader.h"

namespace locsim::scenarios {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

// Two epochs of a receiver that stands still, and the orbit of the one satellite it sees.
void add_raw_epochs(RunResult& result, const LocalFrame& frame) {
  result.gps_start = sim::GpsTime::from_utc("2026-06-01T04:00:00Z");
  result.antenna_ecef_m = frame.to_ecef(Vector3d(0.0, 0.0, 1.5));
  const SatelliteId satellite{.system = GnssSystem::gps, .number = 7};
  for (const double t : {0.2, 0.4}) {
    GnssEpoch epoch{.time = stamp_from_seconds(t), .receiver_time = stamp_from_seconds(t + 1e-4)};
    epoch.observations.push_back({.satellite = satellite,
                                  .pseudorange_m = 2.2e7 + 100.0 * t,
                                  .doppler_hz = -525.5,
                                  .carrier_hz = 1575.42e6,
                                  .cn0_db_hz = 44.0,
                                  .carrier_cycles = 1.156e8,
                                  .carrier_locked = true});
    result.epochs.push_back(epoch);
  }
  const sim::Constellation sky({GnssSystem::gps});
  const sim::SignalInSpace signals(sky, false, 1);
  result.satellites.messages = {signals.broadcast(satellite, result.gps_start)};
}

RunResult example_result() {
  Drive drive = straight_drive(300);
  for (auto& estimate : drive.estimates) {
    estimate.T_map_vehicle.translation.y() = 0.1;
    estimate.T_map_vehicle.rotation = rotation_from_rpy(0.0, 0.0, 0.01);
    estimate.covariance.diagonal() << 0.01, 0.04, 0.09, 1e-4, 4e-4, 9e-4;
  }
  drive.estimates[5].state = localization::State::degraded;
  RunResult result;
  result.scenario = "example";
  result.seed = 7;
  result.localizer = "icp";
  result.scenario_yaml = "name: example\n";
  result.origin = {.latitude_rad = 0.8, .longitude_rad = 0.2, .height_m = 500.0};
  const std::vector<ScoreEvent> events = {{"gnss_outage", tenth(50), tenth(100)}};
  const ScoreInput input{.truth = drive.truth, .estimates = drive.estimates, .events = events};
  result.scores = score_run(input);
  const std::vector<Criterion> criteria = {parse_criterion("ate_rmse_m", "< 0.3"),
                                           parse_criterion("cross_track_max_m", "< 1")};
  result.criteria = evaluate(criteria, result.scores);
  const LocalFrame frame(result.origin);
  GnssFix fix;
  fix.time = stamp_from_seconds(0.2);
  fix.position = frame.to_geodetic({12.0, 3.0, 1.5});
  fix.position_covariance_m2.diagonal() << 1.0, 4.0, 9.0;
  fix.satellites = 12;
  fix.valid = true;
  GnssFix none;
  none.time = stamp_from_seconds(0.4);
  none.satellites = 3;
  fix.hdop = 0.75;
  fix.vdop = 1.25;
  fix.state = FixState::three_dimensional;
  result.fixes = {fix, none};
  add_raw_epochs(result, frame);
  result.truth = drive.truth;
  result.estimates = drive.estimates;
  result.cost.scan_ms_mean = 20.0;
  result.cost.stages_s = {{"lidar", 1.5}};
  return result;
}

class ResultsTest : public testing::Test {
 protected:
  void SetUp() override {
    root_ =
        fs::path(testing::TempDir()) /
        ("results_" + std::string(testing::UnitTest::GetInstance()->current_test_info()->name()));
    fs::remove_all(root_);
    fs::create_directories(root_);
  }
  void TearDown() override { fs::remove_all(root_); }

  [[nodiscard]] std::set<std::string> names(const fs::path& folder) const {
    std::set<std::string> all;
    for (const auto& entry : fs::directory_iterator(folder)) {
      all.insert(entry.path().filename().string());
    }
    return all;
  }
  [[nodiscard]] static std::string error_of(const std::function<void()>& action) {
    try {
      action();
    } catch (const InputError& error) {
      return error.what();
    }
    return "no error";
  }

  fs::path root_;
  RunResult result_ = example_result();
};

TEST_F(ResultsTest, WritesTheFilesOfARun) {
  write_results(result_, root_ / "a" / "run");
  EXPECT_EQ(
      names(root_ / "a" / "run"),
      (std::set<std::string>{"scores.json", "truth.tum", "estimate.tum", "estimate.csv", "gnss.csv",
                             "gnss.obs", "gnss.nav", "gnss.nmea", "imu.csv", "scenario.yaml"}));
  EXPECT_EQ(names(root_ / "a"), std::set<std::string>{"run"});
  EXPECT_EQ(read_text_file(root_ / "a" / "run" / "scenario.yaml"), "name: example\n");
  EXPECT_THAT(read_text_file(root_ / "a" / "run" / "truth.tum"),
              HasSubstr("\n30.000000000 300 0 0 0 0 0 1\n"));
}

TEST_F(ResultsTest, WritesTheReceiversFilesForOtherPrograms) {
  write_results(result_, root_ / "run");
  using testing_gnss::RinexText;
  const RinexText observations(read_text_file(root_ / "run" / "gnss.obs"));
  EXPECT_THAT(observations.line("RINEX VERSION / TYPE"), HasSubstr("3.04"));
  EXPECT_THAT(observations.line("MARKER NAME"), HasSubstr("example"));
  EXPECT_EQ(testing_gnss::number(observations.line("INTERVAL"), 0, 10), 0.2);
  const std::string place = observations.line("APPROX POSITION XYZ");
  for (Eigen::Index axis = 0; axis < 3; ++axis) {
    EXPECT_NEAR(testing_gnss::number(place, static_cast<std::size_t>(14 * axis), 14),
                result_.antenna_ecef_m[axis], 1e-4);
  }
  // Each epoch: its date (of the receiver's clock: 04:00:18.2001 GPS) and its satellite.
  ASSERT_EQ(observations.body.size(), 4U);
  EXPECT_TRUE(observations.body[0].starts_with("> 2026 06 01 04 00 18.2001000"))
      << observations.body[0];
  EXPECT_TRUE(observations.body[1].starts_with("G07")) << observations.body[1];
  EXPECT_EQ(testing_gnss::number(observations.body[1], 3, 14), 2.2e7 + 20.0);

  const RinexText navigation(read_text_file(root_ / "run" / "gnss.nav"));
  EXPECT_THAT(navigation.line("RINEX VERSION / TYPE"), HasSubstr("3.04"));
  ASSERT_EQ(navigation.body.size(), 8U);
  EXPECT_TRUE(navigation.body[0].starts_with("G07 2026 06 01")) << navigation.body[0];

  const std::string sentences = read_text_file(root_ / "run" / "gnss.nmea");  // three of each fix
  EXPECT_EQ(std::ranges::count(sentences, '\n'), 6);
  EXPECT_TRUE(sentences.starts_with("$GNGGA,040000.20,")) << sentences;
  EXPECT_THAT(sentences, HasSubstr("\r\n$GNRMC,040000.40,V,"));
}

TEST_F(ResultsTest, GnssTableHasDilutionAndStateInEveryRow) {
  write_results(result_, root_ / "run");
  std::istringstream table(read_text_file(root_ / "run" / "gnss.csv"));
  std::vector<std::vector<std::string>> rows;
  for (std::string line; std::getline(table, line);) {
    std::istringstream fields(line);
    rows.emplace_back();
    for (std::string field; std::getline(fields, field, ',');) rows.back().push_back(field);
  }
  ASSERT_EQ(rows.size(), 3U);
  for (const auto& row : rows) ASSERT_EQ(row.size(), 21U);
  const auto tail = [](const std::vector<std::string>& row) {
    return std::vector<std::string>(row.end() - 3, row.end());
  };
  EXPECT_EQ(tail(rows[0]), (std::vector<std::string>{"hdop", "vdop", "state"}));
  EXPECT_EQ(tail(rows[1]), (std::vector<std::string>{"0.75", "1.25", "3d"}));
  EXPECT_EQ(tail(rows[2]), (std::vector<std::string>{"", "", "none"}));
  result_.fixes[0].state = FixState::two_dimensional;
  write_results(result_, root_ / "run");
  EXPECT_THAT(read_text_file(root_ / "run" / "gnss.csv"), HasSubstr(",0.75,1.25,2d\n"));
}

TEST_F(ResultsTest, ScoresJsonHoldsWhatIsPromised) {
  const auto json = nlohmann::json::parse(scores_json(result_));
  EXPECT_EQ(json["scenario"], "example");
  EXPECT_EQ(json["seed"], 7);
  EXPECT_EQ(json["localizer"], "icp");
  EXPECT_EQ(json["passed"], false);  // no route, so cross track could not be evaluated
  EXPECT_NEAR(json["scores"]["ate_rmse_m"].get<double>(), 0.1, 1e-12);
  EXPECT_TRUE(json["scores"]["cross_track_max_m"].is_null());
  ASSERT_EQ(json["criteria"].size(), 2U);
  EXPECT_EQ(json["criteria"][0]["passed"], true);
  EXPECT_EQ(json["criteria"][0]["expected"], "< 0.3");
  EXPECT_EQ(json["criteria"][1]["passed"], false);
  EXPECT_TRUE(json["criteria"][1]["value"].is_null());
  ASSERT_EQ(json["events"].size(), 1U);
  EXPECT_EQ(json["events"][0]["kind"], "gnss_outage");
  EXPECT_EQ(json["events"][0]["from_s"], 5.0);
  EXPECT_EQ(json["hash"], result_.hash());
  EXPECT_EQ(json["cost"]["scan_ms_mean"], 20.0);
  EXPECT_EQ(json["cost"]["stages"]["lidar"], 1.5);
}

TEST_F(ResultsTest, PassesOnlyWithAnEstimateAndEveryCriterion) {
  EXPECT_FALSE(result_.passed());
  result_.criteria.pop_back();
  EXPECT_TRUE(result_.passed());
  result_.criteria.clear();
  result_.scores = score_run({});
  EXPECT_FALSE(result_.passed());
}

TEST_F(ResultsTest, ReadBackIsWhatWasWritten) {
  write_results(result_, root_ / "run");
  const RunFiles run = load_run(root_ / "run");
  EXPECT_EQ(run.scenario, "example");
  EXPECT_EQ(run.seed, 7U);
  EXPECT_EQ(run.hash, result_.hash());
  ASSERT_EQ(run.scores.size(), result_.scores.scores.size());
  for (std::size_t i = 0; i < run.scores.size(); ++i) {
    EXPECT_EQ(run.scores[i].name, result_.scores.scores[i].name);
    EXPECT_EQ(run.scores[i].value, result_.scores.scores[i].value);
  }
  ASSERT_EQ(run.truth.size(), 301U);
  EXPECT_EQ(run.truth[17].time, tenth(17));
  EXPECT_EQ(run.truth[17].T_map_vehicle.translation, Vector3d(17.0, 0.0, 0.0));
  ASSERT_EQ(run.estimates.size(), 301U);
  const RunFiles::EstimateRow& row = run.estimates[5];
  EXPECT_EQ(row.time, result_.estimates[5].time);
  EXPECT_EQ(row.T_map_vehicle.translation, result_.estimates[5].T_map_vehicle.translation);
  EXPECT_EQ(row.T_map_vehicle.rotation.coeffs(),
            result_.estimates[5].T_map_vehicle.rotation.coeffs());
  EXPECT_EQ(row.velocity_m_s, Vector3d(10.0, 0.0, 0.0));
  EXPECT_EQ(row.state, localization::State::degraded);
  EXPECT_TRUE(row.sigma_position_m.isApprox(Vector3d(0.1, 0.2, 0.3), 1e-12));
  EXPECT_TRUE(row.sigma_rotation_rad.isApprox(Vector3d(0.01, 0.02, 0.03), 1e-12));
  ASSERT_EQ(run.gnss.size(), 2U);
  EXPECT_TRUE(run.gnss[0].valid);
  EXPECT_EQ(run.gnss[0].satellites, 12);
  // There and back through the ellipsoid: 1e-9 m at an Earth radius of 6e6 m and 2⁻⁵³.
  EXPECT_NEAR((run.gnss[0].position_m - Vector3d(12.0, 3.0, 1.5)).norm(), 0.0, 1e-8);
  EXPECT_TRUE(run.gnss[0].sigma_m.isApprox(Vector3d(1.0, 2.0, 3.0), 1e-12));
  EXPECT_FALSE(run.gnss[1].valid);
  EXPECT_EQ(run.gnss[1].satellites, 3);
}

TEST_F(ResultsTest, KeepsNanosecondsOfGpsTimes) {
  const Stamp time{Duration{1'752'003'258'499'000'123}};
  for (auto& sample : result_.truth) sample.time += time.time_since_epoch();
  write_results(result_, root_ / "run");
  EXPECT_EQ(load_run(root_ / "run").truth[0].time, time);
}

TEST_F(ResultsTest, HashFollowsTheSmallestChangeButNotTheCost) {
  const std::string hash = result_.hash();
  EXPECT_EQ(hash.size(), 16U);
  RunResult same = result_;
  same.cost.scan_ms_mean = 99.0;
  same.scenario_yaml = "other";
  EXPECT_EQ(same.hash(), hash);

  const auto nudge = [](double& value) { value = std::nextafter(value, 1e9); };
  std::set<std::string> hashes = {hash};
  RunResult other = result_;
  nudge(other.truth[100].T_map_vehicle.translation.z());
  hashes.insert(other.hash());
  other = result_;
  nudge(other.estimates[300].covariance(5, 5));
  hashes.insert(other.hash());
  other = result_;
  other.estimates[3].state = localization::State::lost;
  hashes.insert(other.hash());
  other = result_;
  nudge(other.fixes[0].position.height_m);
  hashes.insert(other.hash());
  other = result_;
  nudge(other.epochs[1].observations[0].pseudorange_m);
  hashes.insert(other.hash());
  other = result_;
  nudge(other.epochs[0].observations[0].doppler_hz);
  hashes.insert(other.hash());
  other = result_;
  nudge(other.epochs[0].observations[0].cn0_db_hz);
  hashes.insert(other.hash());
  other = result_;
  nudge(other.epochs[0].observations[0].carrier_cycles);
  hashes.insert(other.hash());
  other = result_;
  other.epochs[0].observations[0].satellite.number = 8;
  hashes.insert(other.hash());
  other = result_;
  other.epochs.pop_back();
  hashes.insert(other.hash());
  other = result_;
  nudge(*other.scores.scores[0].value);
  hashes.insert(other.hash());
  other = result_;
  other.scores.scores[0].value.reset();
  hashes.insert(other.hash());
  other = result_;
  other.estimates.pop_back();
  hashes.insert(other.hash());
  EXPECT_EQ(hashes.size(), 14U);
}

TEST_F(ResultsTest, AllOrNothing) {
  const auto fails = [](const fs::path& folder) {
    EXPECT_TRUE(fs::exists(folder / "scores.json"));
    throw std::runtime_error("no picture");
  };
  EXPECT_THROW(write_results(result_, root_ / "run", fails), std::runtime_error);
  EXPECT_TRUE(names(root_).empty());
  // An earlier run survives a later one that fails.
  write_results(result_, root_ / "run");
  result_.seed = 8;
  EXPECT_THROW(write_results(result_, root_ / "run", fails), std::runtime_error);
  EXPECT_EQ(names(root_), std::set<std::string>{"run"});
  EXPECT_EQ(load_run(root_ / "run").seed, 7U);
}

TEST_F(ResultsTest, ReplacesAnEarlierRunWithItsPictures) {
  const auto draw = [](const fs::path& folder) { std::ofstream(folder / "scan.png") << "x"; };
  write_results(result_, root_ / "run", draw);
  EXPECT_TRUE(fs::exists(root_ / "run" / "scan.png"));
  result_.seed = 8;
  write_results(result_, root_ / "run");
  EXPECT_EQ(load_run(root_ / "run").seed, 8U);
  EXPECT_FALSE(fs::exists(root_ / "run" / "scan.png"));
  EXPECT_EQ(names(root_), std::set<std::string>{"run"});
}

TEST_F(ResultsTest, UsesAnEmptyFolder) {
  fs::create_directories(root_ / "run");
  prepare_output_folder(root_ / "run");
  write_results(result_, root_ / "run/");
  EXPECT_TRUE(fs::exists(root_ / "run" / "scores.json"));
  EXPECT_EQ(names(root_), std::set<std::string>{"run"});
}

TEST_F(ResultsTest, LeavesFoldersOfOthersAlone) {
  fs::create_directories(root_ / "photos");
  std::ofstream(root_ / "photos" / "cat.jpg") << "x";
  const std::string error = error_of([&] { prepare_output_folder(root_ / "photos"); });
  EXPECT_THAT(error,
              HasSubstr((root_ / "photos").string() + ": is not empty and holds no earlier"));
  EXPECT_THAT(error, HasSubstr("--out"));
  EXPECT_THROW(write_results(result_, root_ / "photos"), InputError);

  write_results(result_, root_ / "run");
  std::ofstream(root_ / "run" / "notes.txt") << "x";
  EXPECT_THAT(error_of([&] { prepare_output_folder(root_ / "run"); }), HasSubstr("'notes.txt'"));
  EXPECT_THROW(write_results(result_, root_ / "run"), InputError);
  EXPECT_EQ(load_run(root_ / "run").seed, 7U);
  EXPECT_THAT(error_of([&] { prepare_output_folder(fs::current_path()); }),
              HasSubstr("is the current folder"));
}

TEST_F(ResultsTest, RefusesAFolderThatCannotBeWrittenBeforeTheRun) {
  std::ofstream(root_ / "file") << "x";
  for (const fs::path& folder :
       {root_ / "file", root_ / "file" / "run", root_ / "file" / "a" / "run",
        fs::path("/proc/locsim_run"), fs::path("/proc/self/fd/a/b")}) {
    const std::string error = error_of([&] { prepare_output_folder(folder); });
    EXPECT_THAT(error, HasSubstr(folder.string() + ": ")) << folder;
    EXPECT_THAT(error, HasSubstr("--out")) << folder;
    EXPECT_THROW(write_results(result_, folder), InputError) << folder;
  }
  EXPECT_EQ(names(root_), std::set<std::string>{"file"});
}

TEST_F(ResultsTest, PreparingChangesNothing) {
  prepare_output_folder(root_ / "a" / "b" / "run");
  EXPECT_TRUE(names(root_).empty());
}

TEST_F(ResultsTest, DamagedRunsAreNamedByFileAndLine) {
  const auto error = [&] { return error_of([&] { (void)load_run(root_ / "run"); }); };
  EXPECT_THAT(error(), HasSubstr("is no folder of a run"));
  write_results(result_, root_ / "run");
  const fs::path truth = root_ / "run" / "truth.tum";
  const std::string whole = read_text_file(truth);
  std::ofstream(truth) << whole.substr(0, whole.size() - 5);
  EXPECT_THAT(error(), HasSubstr("truth.tum:302: ends in the middle"));
  std::ofstream(truth) << "# t\n0.000000000 1 2 x 0 0 0 1\n";
  EXPECT_THAT(error(), HasSubstr("truth.tum:2: 'x' is no number"));
  std::ofstream(truth) << "# t\n0.000000000 1 2 3\n";
  EXPECT_THAT(error(), HasSubstr("truth.tum:2: has too few fields"));
  fs::remove(truth);
  EXPECT_THAT(error(), HasSubstr("truth.tum: there is no such file"));
  std::ofstream(root_ / "run" / "scores.json") << "{";
  EXPECT_THAT(error(), HasSubstr("scores.json: is not what a run writes"));
}

}  // namespace
}  // namespace locsim::scenarios
