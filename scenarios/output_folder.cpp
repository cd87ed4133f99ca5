#include "scenarios/output_folder.h"

#include <sys/stat.h>

#include <algorithm>
#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <string>

#include "core/error.h"
#include "scenarios/results.h"

namespace locsim::scenarios {

namespace fs = std::filesystem;

namespace {

constexpr std::string_view kRemedy = "; name another folder with --out";

[[noreturn]] void refuse(const fs::path& folder, const std::string& problem) {
  throw InputError(folder.string() + ": " + problem + std::string(kRemedy));
}

fs::path normal_path(const fs::path& folder) {
  if (folder.empty()) throw InputError("the output folder has no name; name one with --out");
  fs::path normal = fs::absolute(folder).lexically_normal();
  return normal.has_filename() ? normal : normal.parent_path();
}

bool is_ours(const fs::directory_entry& entry) {
  using namespace run_file;
  constexpr std::string_view kOurs[] = {kScores, kTruth,        kEstimateTum, kEstimate,
                                        kGnss,   kObservations, kNavigation,  kNmea,
                                        kImu,    kScenario};
  const std::string name = entry.path().filename().string();
  return entry.is_regular_file() &&
         (std::ranges::find(kOurs, name) != std::end(kOurs) || name.ends_with(".png"));
}

// Throws where something stands at `folder` that is no earlier run of ours.
void check_replaceable(const fs::path& folder) {
  if (!fs::exists(fs::symlink_status(folder))) return;
  const fs::path up_to_here = fs::current_path().lexically_relative(folder);
  if (!up_to_here.empty() && *up_to_here.begin() != "..") {
    refuse(folder, "is the current folder or holds it, and cannot be replaced");
  }
  if (!fs::is_directory(folder)) refuse(folder, "is not a folder");
  struct stat own {};
  struct stat parent {};
  const bool known =
      ::stat(folder.c_str(), &own) == 0 && ::stat(folder.parent_path().c_str(), &parent) == 0;
  if (fs::is_symlink(folder) || !known || own.st_dev != parent.st_dev) {
    refuse(folder,
           "is a mount point or a link, which cannot be replaced as a whole; use a new "
           "folder inside of it, such as " +
               (folder / "run").string());
  }
  if (fs::is_empty(folder)) return;
  if (!fs::exists(folder / run_file::kScores)) {
    refuse(folder, "is not empty and holds no earlier run");
  }
  for (const fs::directory_entry& entry : fs::directory_iterator(folder)) {
    if (is_ours(entry)) continue;
    refuse(folder, "holds an earlier run, but also '" + entry.path().filename().string() +
                       "', which would be lost; move it away or");
  }
}

// A new empty folder whose name begins like `target`'s, in `parent`.
fs::path make_sibling(const fs::path& parent, const fs::path& target) {
  std::string name = (parent / ("." + target.filename().string() + ".partial-XXXXXX")).string();
  if (::mkdtemp(name.data()) == nullptr) {
    refuse(target, "cannot be written, " + parent.string() + ": " + std::strerror(errno));
  }
  ::chmod(name.c_str(), 0755);
  return name;
}

fs::path nearest_existing(fs::path folder) {
  while (!fs::exists(folder) && folder.has_relative_path()) folder = folder.parent_path();
  return folder;
}

}  // namespace

void prepare_output_folder(const fs::path& folder) {
  const fs::path target = normal_path(folder);
  try {
    check_replaceable(target);
    const fs::path parent = nearest_existing(target.parent_path());
    if (!fs::is_directory(parent)) {
      refuse(folder, "cannot be made, " + parent.string() + " is not a folder");
    }
    fs::remove(make_sibling(parent, target));
  } catch (const fs::filesystem_error& error) {
    refuse(folder, "cannot be written, " + error.code().message());
  }
}

PendingFolder::PendingFolder(const fs::path& target) : target_(normal_path(target)) {
  prepare_output_folder(target);
  try {
    fs::create_directories(target_.parent_path());
  } catch (const fs::filesystem_error& error) {
    refuse(target, "cannot be made, " + error.code().message());
  }
  path_ = make_sibling(target_.parent_path(), target_);
}

PendingFolder::~PendingFolder() {
  std::error_code ignored;
  if (!path_.empty()) fs::remove_all(path_, ignored);
}

void PendingFolder::put_in_place() {
  try {
    check_replaceable(target_);
    fs::path replaced;
    if (fs::exists(target_)) {
      replaced = make_sibling(target_.parent_path(), target_);
      fs::rename(target_, replaced);
    }
    std::error_code error;
    fs::rename(path_, target_, error);
    if (error) {
      if (!replaced.empty()) fs::rename(replaced, target_);
      refuse(target_, "cannot be written, " + error.message());
    }
    path_.clear();
    if (!replaced.empty()) fs::remove_all(replaced);
  } catch (const fs::filesystem_error& error) {
    refuse(target_, "cannot be written, " + error.code().message());
  }
}

}  // namespace locsim::scenarios
