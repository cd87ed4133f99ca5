#include "scenarios/scenario_description.h"

#include <algorithm>
#include <array>

#include "core/error.h"
#include "scenarios/presets.h"
#include "scenarios/text_distance.h"
#include "sim/magnetometer/wmm_coefficients.h"

namespace locsim::scenarios {

namespace fs = std::filesystem;

namespace {

constexpr std::string_view kNoPreset = "none";

struct NamedMount {
  std::string_view name;
  Vector3d position_m;
};
const std::array<NamedMount, 3>& named_mounts() {
  static const std::array<NamedMount, 3> mounts = {
      {{"roof", {1.35, 0.0, 1.9}}, {"cabin", {1.0, 0.0, 0.5}}, {"antenna", {0.6, 0.0, 1.6}}}};
  return mounts;
}

}  // namespace

SensorSuite::SensorSuite()
    : lidar{{.preset = "hdl32e", .mount = {.position_m = named_mounts()[0].position_m}}},
      imu{.preset = "mti10", .mount = {.position_m = named_mounts()[1].position_m}},
      gnss{.preset = "ublox_f9p", .mount = {.position_m = named_mounts()[2].position_m}},
      magnetometer{.preset = "mti10", .mount = {.position_m = named_mounts()[2].position_m}} {}

void ScenarioDescription::unsigned_integer(std::string_view key, std::uint64_t& value) {
  auto as_signed = static_cast<std::int64_t>(value);
  p_.integer(key, as_signed, kNotNegative);
  value = static_cast<std::uint64_t>(as_signed);
}

fs::path ScenarioDescription::resolved(std::string_view key, const std::string& text) const {
  const bool by_option = reader_ != nullptr && reader_->is_overridden(key);
  return fs::absolute(by_option ? fs::path(text) : folder_ / text).lexically_normal();
}

void ScenarioDescription::path(std::string_view key, fs::path& path, PathKind kind) {
  std::string text = path.string();
  p_.text(key, text);
  path = existing(key, text, kind);
}

fs::path ScenarioDescription::existing(std::string_view key, const std::string& text,
                                       PathKind kind) {
  const std::string wanted = kind == PathKind::folder ? "a folder" : "a file";
  if (text.empty()) p_.fail(key, "is missing, needs the path of " + wanted);
  fs::path path = resolved(key, text);
  if (reader_ == nullptr) return path;
  if (!fs::exists(path)) {
    p_.fail(key, "is '" + text + "', but there is no " + path.string());
  }
  if (fs::is_directory(path) != (kind == PathKind::folder)) {
    p_.fail(key, "is '" + text + "', needs " + wanted);
  }
  return path;
}

void ScenarioDescription::describe(Scenario& scenario) {
  p_.text("name", scenario.name);
  if (scenario.name.empty()) p_.fail("name", "is empty, needs a name");
  p_.text("about", scenario.about);
  unsigned_integer("seed", scenario.seed);
  p_.text("date", scenario.date);
  check_date(scenario.date);
  p_.number("duration_s", scenario.duration_s, {.min = 0.0, .max = 1e5});
  // The driver acts every 10 ms; nothing reaches it sooner.
  p_.number("latency_s", scenario.latency_s, {.min = 0.01, .max = 1.0});
  const auto group = [this](std::string_view key, auto& setup) {
    p_.begin_group(key);
    describe(setup);
    p_.end_group();
  };
  group("world", scenario.world);
  group("route", scenario.route);
  group("vehicle", scenario.vehicle);
  p_.group("traffic", scenario.traffic);
  group("sensors", scenario.sensors);
  check_imu_rate(scenario);
  check_lidar_rates(scenario);
  p_.list("faults", scenario.faults);
  check_fault_sensors(scenario);
  p_.list("weather", scenario.weather);
  check_weather_times(scenario);
  group("map", scenario.map);
  p_.group("localizer", scenario.localizer);
  describe_expectations(scenario.expect);
}

void ScenarioDescription::describe(WorldSetup& world) {
  constexpr std::array<std::string_view, 2> kKinds = {"town", "mesh"};
  p_.choice("kind", world.kind, kKinds);
  unsigned_integer("seed", world.seed);
  p_.begin_group("origin");
  p_.degrees("latitude_deg", world.origin.latitude_rad, {.min = -89.0, .max = 89.0});
  p_.degrees("longitude_deg", world.origin.longitude_rad, {.min = -180.0, .max = 180.0});
  p_.number("height_m", world.origin.height_m, {.min = -500.0, .max = 9000.0});
  p_.end_group();
  if (world.kind == "town") {
    p_.integer("day", world.day, kNotNegative);
    world.town.describe(p_);
  } else {
    world.mesh.describe(p_);
    world.mesh.file = existing("file", world.mesh.file, PathKind::file).string();
  }
}

void ScenarioDescription::describe(RouteSetup& route) {
  constexpr std::array<std::string_view, 2> kKinds = {"town", "recorded"};
  p_.choice("kind", route.kind, kKinds);
  if (route.kind == "town") {
    route.town.describe(p_);
  } else {
    path("file", route.file, PathKind::file);
    route.recorded.describe(p_);
  }
}

void ScenarioDescription::describe(VehicleSetup& vehicle) {
  constexpr std::array<std::string_view, 1> kKinds = {"sedan"};
  constexpr std::array<std::string_view, 2> kFeedback = {"estimate", "truth"};
  p_.choice("kind", vehicle.kind, kKinds);
  p_.choice("feedback", vehicle.feedback, kFeedback);
  vehicle.spec.describe(p_);
  p_.group("driver", vehicle.driver);
}

void ScenarioDescription::describe(SensorSuite& sensors) {
  sensors.lidar.resize(p_.begin_list("lidar", sensors.lidar.size()), SensorSuite().lidar.front());
  for (std::size_t i = 0; i < sensors.lidar.size(); ++i) {
    p_.begin_item(i);
    describe_sensor("lidar", sensors.lidar[i], MountKeys::pose);
    p_.end_item();
  }
  p_.end_list();
  if (sensors.lidar.empty()) p_.fail("lidar", "is empty, needs at least one LIDAR");
  const auto sensor = [this](std::string_view key, auto& setup, MountKeys mount_keys) {
    p_.begin_group(key);
    describe_sensor(key, setup, mount_keys);
    p_.end_group();
  };
  sensor("imu", sensors.imu, MountKeys::pose);
  sensor("gnss", sensors.gnss, MountKeys::position);
  sensor("magnetometer", sensors.magnetometer, MountKeys::pose);
}

template <typename Spec>
void ScenarioDescription::describe_sensor(std::string_view sensor, SensorSetup<Spec>& setup,
                                          MountKeys mount_keys) {
  describe_preset(sensor, setup.preset);
  describe_mount(setup.mount, mount_keys);
  setup.spec.describe(p_);
}

void ScenarioDescription::describe_preset(std::string_view sensor, std::string& preset) {
  p_.text("preset", preset);
  if (reader_ == nullptr || preset == kNoPreset) return;
  if (const auto text = embedded_preset(sensor, preset)) {
    reader_->add_preset(std::string(*text),
                        "sim/" + std::string(sensor) + "/presets/" + preset + ".yaml");
    return;
  }
  const fs::path file = resolved("preset", preset);
  if (!fs::is_regular_file(file)) {
    const bool meant_as_path = preset.find('/') != std::string::npos || preset.ends_with(".yaml");
    if (meant_as_path) p_.fail("preset", "is '" + preset + "', but there is no " + file.string());
    p_.fail("preset", "is '" + preset +
                          "', needs a preset of this sensor, the path of a YAML file"
                          " or none" +
                          suggestion(preset, preset_names(sensor)));
  }
  reader_->add_preset(read_text_file(file), file.string());
  preset = kNoPreset;
}

void ScenarioDescription::describe_mount(Mount& mount, MountKeys keys) {
  if (reader_ != nullptr && reader_->is_value("mount")) {
    std::vector<std::string_view> names;
    for (const NamedMount& named : named_mounts()) names.push_back(named.name);
    std::string name;
    p_.choice("mount", name, names);
    const auto found = std::ranges::find(named_mounts(), name, &NamedMount::name);
    mount = {.position_m = found->position_m};
    return;
  }
  p_.begin_group("mount");
  if (keys == MountKeys::pose) {
    mount.describe_pose(p_);
  } else {
    mount.describe_position(p_);
  }
  p_.end_group();
}

void ScenarioDescription::check_date(const std::string& date) {
  double year = 0.0;
  try {
    year = sim::GpsTime::from_utc(date).decimal_year();
  } catch (const InputError& error) {
    const std::string message = error.what();
    p_.fail("date", "is '" + date + "', " + message.substr(message.rfind(": ") + 2));
  }
  if (year < sim::kWmmEpoch_year || year > sim::kWmmEnd_year) {
    p_.fail("date", "is '" + date +
                        "', needs a date from 2025 to 2029: the model of the earth's magnetic field"
                        " covers no other");
  }
}

void ScenarioDescription::check_imu_rate(const Scenario& scenario) {
  if (reader_ == nullptr) return;
  try {
    (void)scenario.sensors.imu.spec.steps_per_sample(scenario.vehicle.spec.step);
  } catch (const InputError& error) {
    const std::string message = error.what();
    p_.begin_group("sensors");
    p_.begin_group("imu");
    p_.fail("rate_hz", message.substr(std::min(message.find("is "), message.size())));
  }
}

void ScenarioDescription::check_lidar_rates(const Scenario& scenario) {
  if (reader_ == nullptr) return;
  const std::vector<LidarSetup>& lidars = scenario.sensors.lidar;
  std::string problem;
  std::size_t where = 0;
  for (std::size_t i = 0; i < lidars.size() && problem.empty(); ++i) {
    where = i;
    const std::string rate = "is " + shortest_text(lidars[i].spec.rate_hz);
    if (lidars[i].spec.period() % kControlPeriod != Duration::zero()) {
      problem = rate + ", needs a revolution of whole 10 ms: 5, 10, 20, 25 or 50";
    } else if (lidars[i].spec.period() != lidars[0].spec.period()) {
      problem = rate + ", needs the rate of the first LIDAR: they turn together";
    }
  }
  if (problem.empty()) return;
  p_.begin_group("sensors");
  static_cast<void>(p_.begin_list("lidar", lidars.size()));
  p_.begin_item(where);
  p_.fail("rate_hz", problem);
}

void ScenarioDescription::check_fault_sensors(const Scenario& scenario) {
  if (reader_ == nullptr) return;
  const auto lidars = static_cast<int>(scenario.sensors.lidar.size());
  for (std::size_t i = 0; i < scenario.faults.size(); ++i) {
    const int sensor = std::visit(
        [](const auto& fault) {
          if constexpr (requires { fault.sensor; }) return fault.sensor;
          return -1;
        },
        scenario.faults[i].kind);
    if (sensor < lidars) continue;
    static_cast<void>(p_.begin_list("faults", scenario.faults.size()));
    p_.begin_item(i);
    p_.fail("sensor", "is " + std::to_string(sensor) + ", needs the place of a LIDAR, 0 to " +
                          std::to_string(lidars - 1) + ", or -1 for all");
  }
}

void ScenarioDescription::check_weather_times(const Scenario& scenario) {
  if (reader_ == nullptr) return;
  for (std::size_t i = 1; i < scenario.weather.size(); ++i) {
    const double before_s = scenario.weather[i - 1].at_s;
    if (scenario.weather[i].at_s > before_s) continue;
    static_cast<void>(p_.begin_list("weather", scenario.weather.size()));
    p_.begin_item(i);
    p_.fail("at_s", "is " + shortest_text(scenario.weather[i].at_s) + ", needs a time after the " +
                        shortest_text(before_s) + " before it");
  }
}

void ScenarioDescription::describe(MapSetup& map) {
  constexpr std::array<std::string_view, 2> kSources = {"survey", "file"};
  p_.choice("source", map.source, kSources);
  if (map.source == "survey") {
    map.survey.describe(p_);
    p_.integer("day", map.day, kNotNegative);
    p_.flag("parked_cars", map.parked_cars);
  } else {
    path("file", map.file, PathKind::folder);
  }
  p_.number("stale", map.stale, kShare);
}

void ScenarioDescription::describe_expectations(std::vector<Criterion>& expect) {
  p_.begin_group("expect");
  if (reader_ == nullptr) {
    for (Criterion& criterion : expect) p_.text(criterion.score, criterion.text);
  } else {
    expect.clear();
    for (const std::string& score : reader_->keys()) {
      std::string text;
      p_.text(score, text);
      try {
        expect.push_back(parse_criterion(score, text));
      } catch (const InputError& error) {
        p_.fail(score, error.what());
      }
    }
  }
  p_.end_group();
}

}  // namespace locsim::scenarios
