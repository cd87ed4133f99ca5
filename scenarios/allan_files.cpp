#include "scenarios/allan_files.h"

#include <array>
#include <cmath>
#include <nlohmann/json.hpp>
#include <string>

#include "scenarios/yaml_parameters.h"

namespace locsim::scenarios {

namespace {

using Json = nlohmann::ordered_json;
constexpr std::array<const char*, 3> kAxes = {"x", "y", "z"};

Json number(double value) {
  return std::isfinite(value) ? Json(value) : Json(nullptr);
}

Json in_unit(const sim::AllanCoefficient& c, std::string_view unit, double factor) {
  return {{"value", number(c.value / factor)},
          {"sigma", number(c.sigma / factor)},
          {"below_95", number(c.upper_bound / factor)},
          {"unit", std::string(unit)}};
}

Json fit_json(const sim::AllanFit& fit, const AllanUnits& units) {
  Json json;
  for (std::size_t term = 0; term < sim::kAllanTerms; ++term) {
    const sim::AllanCoefficient& c = fit.coefficients[term];
    const AllanUnit& unit = units[term];
    json[std::string(unit.symbol)] = {{"name", std::string(unit.name)},
                                      {"seen", c.seen},
                                      {"si", in_unit(c, unit.si, 1.0)},
                                      {"data_sheet", in_unit(c, unit.data_sheet, unit.factor)}};
  }
  json["minimum"] = {{"tau_s", fit.minimum_tau_s},
                     {"deviation", number(fit.minimum_deviation)},
                     {"bias_instability", number(fit.minimum_bias_instability())}};
  json["model_error"] = number(fit.model_error);
  return json;
}

Json triad_json(const sim::AllanTriadFit& triad, const AllanUnits& units) {
  Json json;
  for (std::size_t axis = 0; axis < kAxes.size(); ++axis) {
    json[kAxes[axis]] = fit_json(triad.axes[axis], units);
  }
  json["together"] = fit_json(triad.together, units);
  return json;
}

Json model_json(const sim::AllanModel& model, const AllanUnits& units) {
  Json json;
  for (std::size_t term = 0; term < sim::kAllanTerms; ++term) {
    const double value = model.coefficient(static_cast<sim::AllanTerm>(term));
    const AllanUnit& unit = units[term];
    json[std::string(unit.symbol)] = {
        {"si", {{"value", value}, {"unit", std::string(unit.si)}}},
        {"data_sheet", {{"value", value / unit.factor}, {"unit", std::string(unit.data_sheet)}}}};
  }
  return json;
}

void append_point(std::string& row, const sim::AllanPoint& point, const sim::AllanModel& fitted,
                  const sim::AllanModel* specified) {
  const double deviation = std::sqrt(point.variance);
  row += "," + shortest_text(deviation);
  row += "," + shortest_text(deviation * sim::relative_sigma(point, fitted));
  row += "," + shortest_text(fitted.deviation(point.tau_s));
  if (specified != nullptr) row += "," + shortest_text(specified->deviation(point.tau_s));
}

}  // namespace

std::string allan_json(const AllanReport& report) {
  Json json = {{"source", report.source},
               {"rate_hz", report.rate_hz},
               {"used_s", report.used_s},
               {"longest_stretch_s", report.longest_s},
               {"notes", report.notes}};
  json["gyro"] = triad_json(report.fit.gyro, gyro_allan_units());
  json["accelerometer"] = triad_json(report.fit.accelerometer, accelerometer_allan_units());
  if (report.specified) {
    json["specified"] = {{"name", report.specified_name},
                         {"gyro", model_json(report.specified->gyro, gyro_allan_units())},
                         {"accelerometer", model_json(report.specified->accelerometer,
                                                      accelerometer_allan_units())}};
  }
  if (!report.nearest.empty()) json["nearest"] = Json::array();
  for (const AllanReport::Ranked& ranked : report.nearest) {
    json["nearest"].push_back({{"preset", ranked.preset},
                               {"mean_log10_ratio", number(ranked.distance.mean_log10_ratio)},
                               {"seen", ranked.distance.seen},
                               {"by_bound", ranked.distance.by_bound}});
  }
  return json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

std::string allan_csv(const AllanReport& report) {
  std::string text = "tau_s";
  const auto header = [&](const std::string& sensor, const std::string& unit) {
    for (const std::string axis : kAxes) {
      const std::string signal = "," + sensor + "_" + axis;
      text += signal + "_" + unit + signal + "_sigma_" + unit + signal + "_fitted_" + unit;
      if (report.specified) text += signal + "_specified_" + unit;
    }
  };
  header("gyro", "rad_s");
  header("accel", "m_s2");
  text += '\n';
  const sim::ImuAllanModel* specified = report.specified ? &*report.specified : nullptr;
  for (std::size_t i = 0; i < report.curves.gyro[0].size(); ++i) {
    text += shortest_text(report.curves.gyro[0][i].tau_s);
    for (std::size_t axis = 0; axis < kAxes.size(); ++axis) {
      append_point(text, report.curves.gyro[axis][i], report.fit.gyro.axes[axis].model,
                   specified != nullptr ? &specified->gyro : nullptr);
    }
    for (std::size_t axis = 0; axis < kAxes.size(); ++axis) {
      append_point(text, report.curves.accelerometer[axis][i],
                   report.fit.accelerometer.axes[axis].model,
                   specified != nullptr ? &specified->accelerometer : nullptr);
    }
    text += '\n';
  }
  return text;
}

}  // namespace locsim::scenarios
