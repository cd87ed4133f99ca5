// weather_scans SCENARIO.yaml OUT_FOLDER: one scan of the scenario's first LIDAR half way along the
// route in clear air, fog, rain, snow and dust. Prints a table of what is lost and gained; writes
// weather.png.

#include <cstdio>
#include <exception>
#include <filesystem>
#include <string>
#include <vector>

#include "benchmarks/fidelity/weather_picture.h"
#include "benchmarks/fidelity/weather_scans.h"

namespace {

namespace fs = std::filesystem;
using namespace locsim;

void show(const fs::path& scenario, const fs::path& out) {
  const std::vector<fidelity::WeatherScan> scans = fidelity::scan_weathers(scenario);
  std::fputs(fidelity::weather_table(scans).c_str(), stdout);
  fs::create_directories(out);
  render::write_png(fidelity::draw_weathers(std::span(scans).first(4)), out / "weather.png");
}

}  // namespace

int main(int argc, char** argv) {
  const std::vector<std::string> arguments(argv + 1, argv + argc);
  if (arguments.size() != 2) {
    std::fputs("usage: weather_scans SCENARIO.yaml OUT_FOLDER\n", stderr);
    return 2;
  }
  try {
    show(arguments[0], arguments[1]);
    return 0;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "weather_scans: %s\n", error.what());
    return 2;
  }
}
