#pragma once

#include <filesystem>
#include <string_view>

namespace locsim::scenarios {

/// Names of the files in a run's folder. Pictures beside them end in ".png".
namespace run_file {
inline constexpr std::string_view kScores = "scores.json";
inline constexpr std::string_view kTruth = "truth.tum";
inline constexpr std::string_view kEstimateTum = "estimate.tum";
inline constexpr std::string_view kEstimate = "estimate.csv";
inline constexpr std::string_view kGnss = "gnss.csv";
inline constexpr std::string_view kObservations = "gnss.obs";
inline constexpr std::string_view kNavigation = "gnss.nav";
inline constexpr std::string_view kNmea = "gnss.nmea";
inline constexpr std::string_view kImu = "imu.csv";
inline constexpr std::string_view kScenario = "scenario.yaml";
}  // namespace run_file

/// A new folder beside the one that it is to become. Goes away with its files unless put in place.
class PendingFolder {
 public:
  /// Throws InputError where `target` must not be replaced or cannot be written.
  explicit PendingFolder(const std::filesystem::path& target);
  PendingFolder(const PendingFolder&) = delete;
  PendingFolder& operator=(const PendingFolder&) = delete;
  ~PendingFolder();

  [[nodiscard]] const std::filesystem::path& path() const { return path_; }
  /// Renames it to the target; an earlier run there is removed.
  void put_in_place();

 private:
  std::filesystem::path target_;
  std::filesystem::path path_;
};

}  // namespace locsim::scenarios
