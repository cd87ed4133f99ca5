// lidar_fidelity KITTI_FOLDER [SCENARIO.yaml] [OUT_FOLDER]: an HDL-64E in a real street and in a
// simulated one. Prints both streets' figures; writes kitti_scans.png, kitti_figures.png and
// kitti_reflections.png where a folder is named.

#include <algorithm>
#include <cstdio>
#include <exception>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "benchmarks/fidelity/figures_text.h"
#include "benchmarks/fidelity/simulated_street.h"
#include "benchmarks/fidelity/street_pictures.h"

namespace {

namespace fs = std::filesystem;
using namespace locsim;

int compare(std::span<const std::string> arguments) {
  const fs::path scenario =
      arguments.size() > 1 ? fs::path(arguments[1])
                           : fs::path(LOCSIM_SOURCE_DIR "/scenarios/library/kitti_street.yaml");
  const std::vector<fidelity::LaserScan> real = fidelity::read_drive(arguments[0]);
  const std::vector<fidelity::LaserScan> simulated = fidelity::scan_street(scenario);
  const fidelity::StreetFigures real_figures = fidelity::street_figures(real);
  const fidelity::StreetFigures simulated_figures = fidelity::street_figures(simulated);
  std::fputs(fidelity::figures_text(real_figures, simulated_figures).c_str(), stdout);
  if (arguments.size() < 3) return 0;
  const fs::path out = arguments[2];
  fs::create_directories(out);
  render::write_png(fidelity::draw_scans(real[real.size() / 2], simulated[simulated.size() / 2]),
                    out / "kitti_scans.png");
  render::write_png(fidelity::draw_figures(real_figures, simulated_figures),
                    out / "kitti_figures.png");
  render::write_png(fidelity::draw_reflections(real_figures, simulated_figures),
                    out / "kitti_reflections.png");
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  const std::vector<std::string> arguments(argv + 1, argv + argc);
  if (arguments.empty() || arguments.size() > 3) {
    std::fputs("usage: lidar_fidelity KITTI_FOLDER [SCENARIO.yaml] [OUT_FOLDER]\n", stderr);
    return 2;
  }
  try {
    return compare(arguments);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "lidar_fidelity: %s\n", error.what());
    return 2;
  }
}
