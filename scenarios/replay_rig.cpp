#include "scenarios/replay_rig.h"

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
constexpr Bounds kMountBounds{.min = -20.0, .max = 20.0};
constexpr Bounds kTurnBounds{.min = -360.0, .max = 360.0};

// Names each key of a rig file once, for reading and for writing.
class RigDescription {
 public:
  // `reader` is `p` where a file is being read, otherwise null; files are relative to `folder`.
  RigDescription(Parameters& p, YamlReader* reader, fs::path folder)
      : p_(p), reader_(reader), folder_(std::move(folder)) {}

  void describe(ReplayRig& rig) {
    p_.begin_group("imu");
    describe_preset(rig.imu);
    describe_mount(rig.imu.mount, true);
    rig.imu.spec.describe(p_);
    p_.end_group();
    p_.begin_group("gnss");
    describe_mount(rig.gnss_mount, false);
    p_.number("latency_s", rig.gnss_latency_s, {.min = 0.0, .max = 10.0});
    p_.end_group();
    p_.begin_group("localizer");
    describe_localizer(rig.localizer);
    p_.end_group();
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

  void describe_mount(Mount& mount, bool has_direction) {
    p_.begin_group("mount");
    p_.number("x_m", mount.position_m.x(), kMountBounds);
    p_.number("y_m", mount.position_m.y(), kMountBounds);
    p_.number("z_m", mount.position_m.z(), kMountBounds);
    if (has_direction) {
      p_.degrees("roll_deg", mount.roll_pitch_yaw_rad.x(), kTurnBounds);
      p_.degrees("pitch_deg", mount.roll_pitch_yaw_rad.y(), kTurnBounds);
      p_.degrees("yaw_deg", mount.roll_pitch_yaw_rad.z(), kTurnBounds);
    }
    p_.end_group();
  }

  void describe_localizer(LocalizerSetup& localizer) {
    std::vector<std::string_view> kinds;
    for (const localization::LocalizerKind& kind : localization::localizer_kinds()) {
      kinds.push_back(kind.name);
    }
    const std::string before = localizer.kind;
    p_.choice("kind", localizer.kind, kinds);
    if (localizer.kind != before) {
      localizer.settings = localization::make_localizer_settings(localizer.kind);
    }
    localizer.settings->describe(p_);
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
  localization::Rig rig;
  rig.T_vehicle_imu = imu.mount.pose();
  rig.antenna_in_vehicle_m = gnss_mount.position_m;
  rig.imu_rate_hz = imu_rate_hz;
  rig.gyro_noise_rad_s_sqrthz = imu.spec.gyro_noise_rad_s_sqrthz();
  rig.accel_noise_m_s2_sqrthz = imu.spec.accelerometer_noise_m_s2_sqrthz();
  rig.gyro_bias_walk_rad_s2_sqrthz = imu.spec.gyro_bias_walk_rad_s_sqrts();
  rig.accel_bias_walk_m_s3_sqrthz = imu.spec.accelerometer_bias_walk_m_s2_sqrts();
  return rig;
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
