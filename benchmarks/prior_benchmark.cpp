#include <tbb/global_control.h>

#include <array>
#include <cstdio>
#include <memory>
#include <numbers>
#include <string>
#include <variant>
#include <vector>

#include "benchmarks/drive_messages.h"
#include "benchmarks/figures.h"
#include "benchmarks/kitti_drive.h"
#include "benchmarks/prior_chain.h"
#include "localization/dynamic_icp/dynamic_icp_localizer.h"
#include "localization/preprocess/deskew.h"

/// What an IMU is worth to registration: the same scans, each method from its own last result, as
/// a Markdown table. One thread.
namespace {

using namespace locsim;
using namespace locsim::benchmarks;
using localization::Alignment;
using localization::DynamicIcp;
using localization::DynamicIcpResult;
using localization::DynamicIcpStatus;

constexpr double kDrive_s = 60.0;
/// A pose so far off is wrong.
constexpr double kWrong_m = 0.5;

/// A scan, and what the IMU said since the one before it.
struct Frame {
  const LidarScan* scan = nullptr;
  std::vector<ImuSample> imu;
  std::vector<std::uint32_t> picked;
  /// As they came, vehicle frame.
  std::vector<Vector3f> skewed;
  /// At the scan's end, by the IMU.
  std::vector<Vector3f> deskewed;
};

std::vector<Frame> frames_of(const DriveMessages& drive) {
  const localization::Rig& rig = drive.inputs.rig;
  std::vector<Frame> frames(1);
  for (const Message& message : drive.messages) {
    Frame& frame = frames.back();
    if (const auto* sample = std::get_if<ImuSample>(&message)) frame.imu.push_back(*sample);
    if (const auto* scan = std::get_if<LidarScan>(&message)) {
      frame.scan = scan;
      frame.picked =
          localization::pick_points(*scan, rig, localization::DynamicIcpLocalizerConfig{}.points);
      for (const std::uint32_t i : frame.picked) {
        const LidarPoint& p = scan->points[i];
        frame.skewed.push_back((rig.T_vehicle_lidar[p.sensor] * p.position()).cast<float>());
      }
      frames.emplace_back();
    }
  }
  frames.pop_back();
  return frames;
}

enum class PriorKind { imu, constant_velocity, last_pose };
enum class DeskewKind { by_imu, by_constant_velocity, none };

struct Method {
  PriorKind prior;
  DeskewKind deskew;
};

std::string to_string(PriorKind prior) {
  switch (prior) {
    case PriorKind::imu:
      return "IMU";
    case PriorKind::constant_velocity:
      return "constant velocity";
    case PriorKind::last_pose:
      break;
  }
  return "last pose";
}

std::string to_string(DeskewKind deskew) {
  switch (deskew) {
    case DeskewKind::by_imu:
      return "IMU";
    case DeskewKind::by_constant_velocity:
      return "constant velocity";
    case DeskewKind::none:
      break;
  }
  return "–";
}

struct Tally {
  int scans = 0;
  int converged = 0;
  int wrong = 0;
  std::vector<double> guess_off_cm;
  std::vector<double> iterations;
  std::vector<double> worked_ms;
  std::vector<double> error_cm;
  std::vector<double> turn_deg;

  void add(const Pose& guess, const DynamicIcpResult& result, const Pose& taken, const Pose& truth,
           const Stopwatch::Lap& cost) {
    ++scans;
    if (result.status == DynamicIcpStatus::converged) ++converged;
    const double error_m = (taken.translation - truth.translation).norm();
    if (error_m > kWrong_m) ++wrong;
    guess_off_cm.push_back(100.0 * (guess.translation - truth.translation).norm());
    iterations.push_back(result.iterations);
    worked_ms.push_back(cost.worked_ms);
    error_cm.push_back(100.0 * error_m);
    turn_deg.push_back(so3::log(truth.rotation.conjugate() * taken.rotation).norm() * 180.0 /
                       std::numbers::pi);
  }

  void print(const std::string& drive, const Method& method) const {
    const double percent = 100.0 / scans;
    std::printf(
        "| %s | %s | %s | %.1f | %.1f | %.1f | %.2f | %.2f | %.1f / %.1f | "
        "%.3f / %.3f | %.1f |\n",
        drive.c_str(), to_string(method.prior).c_str(), to_string(method.deskew).c_str(),
        percent * converged, quantile(guess_off_cm, 0.5), mean(iterations), mean(worked_ms),
        quantile(worked_ms, 0.99), mean(error_cm), quantile(error_cm, 0.95), mean(turn_deg),
        quantile(turn_deg, 0.95), percent * wrong);
    std::fflush(stdout);
  }
};

/// What the method takes for the pose: where nothing converged, its own guess.
Pose step(Prior& prior, const Pose& guess, Stamp time, const DynamicIcpResult& result) {
  const bool converged = result.status == DynamicIcpStatus::converged;
  const Pose taken = converged ? result.alignment.T_map_vehicle : guess;
  prior.take(taken, time, converged ? &result.alignment : nullptr);
  return taken;
}

/// Deskewed scans are those of their end; others fit best where the vehicle was at their middle.
/// The first method to deskew by the IMU does so for all.
Tally run(const DriveMessages& drive, std::vector<Frame>& frames, const Method& method) {
  const bool deskews = method.deskew != DeskewKind::none;
  const auto time_of = [&](const LidarScan& scan) {
    return deskews ? scan.end : scan.start + (scan.end - scan.start) / 2;
  };
  const sim::TruthState& start = drive.truth.front();
  std::unique_ptr<Prior> prior;
  if (method.prior == PriorKind::imu) {
    prior = std::make_unique<ImuPrior>(drive.inputs, start);
  } else {
    prior = std::make_unique<PosePrior>(start.time, start.T_map_vehicle,
                                        method.prior == PriorKind::constant_velocity);
  }
  DynamicIcp registration(*drive.inputs.map, {});
  Tally tally;
  for (Frame& frame : frames) {
    for (const ImuSample& sample : frame.imu) prior->listen(sample);
    const Stamp time = time_of(*frame.scan);
    if (time <= start.time) continue;
    const std::optional<Pose> truth = drive.truth_at(time);
    if (!truth) break;
    std::vector<Vector3f> own;
    const std::vector<Vector3f>* points = &frame.skewed;
    if (deskews) {
      points = method.deskew == DeskewKind::by_imu ? &frame.deskewed : &own;
      if (points->empty()) {
        own = localization::deskew(*frame.scan, frame.picked, prior->motion(time), time,
                                   drive.inputs.rig);
        if (method.deskew == DeskewKind::by_imu) frame.deskewed = own;
      }
    }
    const Pose guess = prior->guess(time);
    Stopwatch stopwatch;
    const DynamicIcpResult result = registration.track(*points, guess);
    const Stopwatch::Lap cost = stopwatch.lap();
    tally.add(guess, result, step(*prior, guess, time, result), *truth, cost);
  }
  return tally;
}

/// Every scan against a map of the others; nothing is deskewed, the map's scans are not either.
Tally run_kitti(const KittiDrive& drive, const Method& method) {
  const auto time_of = [](std::size_t scan) {
    return Stamp{} + static_cast<std::int64_t>(scan) * Duration(std::chrono::milliseconds(100));
  };
  PosePrior prior(time_of(0), drive.T_odom_lidar[0], method.prior == PriorKind::constant_velocity);
  Tally tally;
  for (std::size_t i = 1; i < drive.scans.size(); ++i) {
    const std::vector<Vector3f> points = thinned(drive.scans[i], kScanVoxel_m);
    const Pose guess = prior.guess(time_of(i));
    DynamicIcp registration(drive.map_without(i, drive.scans.size()), {});
    // The map's surfels are made beforehand: on a drive they are made once for many scans.
    static_cast<void>(registration.track(points, drive.T_odom_lidar[i]));
    Stopwatch stopwatch;
    const DynamicIcpResult result = registration.track(points, guess);
    const Stopwatch::Lap cost = stopwatch.lap();
    tally.add(guess, result, step(prior, guess, time_of(i), result), drive.T_odom_lidar[i], cost);
  }
  return tally;
}

constexpr std::array<Method, 7> kMethods{
    {{PriorKind::imu, DeskewKind::by_imu},
     {PriorKind::constant_velocity, DeskewKind::by_imu},
     {PriorKind::last_pose, DeskewKind::by_imu},
     {PriorKind::constant_velocity, DeskewKind::by_constant_velocity},
     {PriorKind::imu, DeskewKind::none},
     {PriorKind::constant_velocity, DeskewKind::none},
     {PriorKind::last_pose, DeskewKind::none}}};

void print_town(const std::string& lidar) {
  const DriveMessages drive = record_town_drive(lidar, kDrive_s);
  std::vector<Frame> frames = frames_of(drive);
  for (const Method& method : kMethods) run(drive, frames, method).print(lidar, method);
}

void print_kitti() {
  const KittiDrive& kitti = kitti_drive();
  if (kitti.scans.empty()) {
    std::fprintf(stderr, "no drive in %s; LOCSIM_DATA_DIR names the folder of drives\n",
                 kitti_folder().c_str());
    return;
  }
  for (const PriorKind prior : {PriorKind::constant_velocity, PriorKind::last_pose}) {
    const Method method{prior, DeskewKind::none};
    run_kitti(kitti, method).print("kitti_0005", method);
  }
}

}  // namespace

/// Arguments: presets of LIDARs, kitti_0005; without any, all of them.
int main(int count, char** arguments) {
  const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, 1);
  std::vector<std::string> drives(arguments + 1, arguments + count);
  if (drives.empty()) drives = {"hdl32e", "hdl64e", "kitti_0005"};
  std::puts(
      "| drive | prior | deskewed by | converged % | prior off, median cm | iterations | ms of "
      "work "
      "a scan | p99 | error cm, mean / p95 | error °, mean / p95 | over 0.5 m off, % |\n"
      "|---|---|---|---|---|---|---|---|---|---|---|");
  for (const std::string& drive : drives) {
    if (drive == "kitti_0005") {
      print_kitti();
    } else {
      print_town(drive);
    }
  }
}
