#include "scenarios/replay_rig.h"

#include <algorithm>
#include <vector>

#include "core/error.h"
#include "scenarios/imu_presets.h"
#include "scenarios/output_folder.h"
#include "scenarios/presets.h"
#include "scenarios/text_distance.h"
#include "scenarios/yaml_parameters.h"

namespace locsim::scenarios {

namespace fs = std::filesystem;

namespace {

constexpr std::string_view kNoPreset = "none";
constexpr const char* kDefaultLocalizer = "gnss_ins";

// Names each key of a rig file once, for reading and for writing.
class RigDescription {
 public:
  // `reader` is `p` where a file is being read, otherwise null; files are relative to `folder`.
  RigDescription(Parameters& p, YamlReader* reader, fs::path folder)
      : p_(p), reader_(reader), folder_(std::move(folder)) {}

  void describe(ReplayRig& rig) {
    p_.begin_group("imu");
    describe_preset(rig.imu);
    p_.begin_group("mount");
    rig.imu.mount.describe_pose(p_);
    p_.end_group();
    rig.imu.spec.describe(p_);
    p_.end_group();
    p_.begin_group("gnss");
    p_.begin_group("mount");
    rig.gnss_mount.describe_position(p_);
    p_.end_group();
    p_.number("latency_s", rig.gnss_latency_s, {.min = 0.0, .max = 10.0});
    p_.end_group();
    p_.group("localizer", rig.localizer);
  }

 private:
  void describe_preset(ImuSetup& imu) {
    p_.text("preset", imu.preset);
    if (reader_ == nullptr || imu.preset == kNoPreset || !p_.has("preset")) return;
    if (embedded_preset("imu", imu.preset)) {
      imu.spec = load_imu(imu.preset).spec;
      return;
    }
    const fs::path file =
        reader_->is_overridden("preset") ? fs::path(imu.preset) : folder_ / imu.preset;
    if (!fs::is_regular_file(file)) {
      p_.fail("preset", "is '" + imu.preset +
                            "', needs a preset of an IMU, the path of a YAML file or none" +
                            suggestion(imu.preset, preset_names("imu")));
    }
    imu.spec = load_imu(file.string()).spec;
    imu.preset = kNoPreset;
  }

  Parameters& p_;
  YamlReader* reader_;
  fs::path folder_;
};

ReplayRig read_rig(ReplayRig rig, const fs::path& file, std::span<const std::string> overrides) {
  YamlReader reader = file.empty() ? YamlReader("{}", "the rig", overrides)
                                   : YamlReader::from_file(file, overrides);
  RigDescription(reader, &reader, file.parent_path()).describe(rig);
  reader.finish();
  return rig;
}

ReplayRig default_rig(const fs::path& log_folder) {
  ReplayRig rig;
  const fs::path scenario_file = log_folder / run_file::kScenario;
  if (!fs::exists(scenario_file)) return rig;
  const SensorSuite sensors = load_scenario(scenario_file).sensors;
  rig.imu = sensors.imu;
  rig.gnss_mount = sensors.gnss.mount;
  return rig;
}

}  // namespace

ReplayRig::ReplayRig() {
  imu.spec = load_imu(imu.preset).spec;
  localizer.kind = kDefaultLocalizer;
  localizer.settings = localization::make_localizer_settings(localizer.kind);
}

localization::Rig ReplayRig::rig(double imu_rate_hz) const {
  localization::Rig rig = inertial_rig(imu, gnss_mount);
  rig.imu_rate_hz = imu_rate_hz;
  rig.gyro_noise_rad_s_sqrthz =
      std::max(rig.gyro_noise_rad_s_sqrthz, measured_noise.gyro_rad_s_sqrthz);
  rig.accel_noise_m_s2_sqrthz =
      std::max(rig.accel_noise_m_s2_sqrthz, measured_noise.accel_m_s2_sqrthz);
  return rig;
}

void ReplayRig::tell_imu_noise(const ImuNoise& measured) {
  measured_noise = measured;
  YamlReader reader("imu_noise_scale: 1", "the IMU's noise");
  localizer.settings->describe(reader);
}

void ReplayRig::tell_velocity_delay(Duration delay) {
  YamlReader reader("gnss: {velocity_delay_s: " + shortest_text(to_seconds(delay)) + "}",
                    "the velocities' delay");
  // A localizer without the key does not ask for it.
  localizer.settings->describe(reader);
}

ReplayRig load_replay_rig(const fs::path& file, const fs::path& log_folder,
                          const std::string& localizer, std::span<const std::string> overrides) {
  const ReplayRig defaults = default_rig(log_folder);
  std::vector<std::string> all(overrides.begin(), overrides.end());
  // The file's settings stay where it already names this localizer; another kind has other keys.
  if (!localizer.empty() && read_rig(defaults, file, {}).localizer.kind != localizer) {
    all.insert(all.begin(), "localizer={kind: " + localizer + "}");
  }
  return read_rig(defaults, file, all);
}

std::string to_yaml(const ReplayRig& rig) {
  ReplayRig copy = rig;
  YamlWriter writer;
  RigDescription(writer, nullptr, {}).describe(copy);
  return writer.str();
}

}  // namespace locsim::scenarios
