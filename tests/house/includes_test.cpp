#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <map>
#include <regex>
#include <string>
#include <vector>

namespace {

namespace fs = std::filesystem;

// Folder -> folders it may include, itself among them. `maps/build` is a target of its own.
const std::map<std::string, std::vector<std::string>> kAllowed = {
    {"core", {"core"}},
    {"maps", {"core", "maps"}},
    {"localization", {"core", "maps", "localization"}},
    {"maps/build", {"core", "maps", "localization", "maps/build"}},
    {"sim", {"core", "sim"}},
    {"render", {"core", "maps", "render"}},
    {"scenarios", {"core", "maps", "localization", "maps/build", "sim", "scenarios"}},
    {"apps", {"core", "maps", "localization", "maps/build", "sim", "scenarios", "render", "apps"}},
};

// Libraries that only some folders may see in their headers.
const std::vector<std::string> kOutOfHeaders = {"pcl/", "yaml-cpp/", "btBullet", "GL/", "assimp/"};

std::string folder_of(const std::string& path) {
  if (path.starts_with("maps/build/")) return "maps/build";
  return path.substr(0, path.find('/'));
}

bool is_ours(const std::string& included) {
  return kAllowed.contains(included.substr(0, included.find('/')));
}

struct Include {
  std::string file;
  std::string included;
};

std::vector<Include> includes_below(const fs::path& root, const std::string& folder,
                                    const std::regex& pattern) {
  std::vector<Include> found;
  for (const auto& entry : fs::recursive_directory_iterator(root / folder)) {
    const std::string extension = entry.path().extension().string();
    if (extension != ".h" && extension != ".cpp") continue;
    std::ifstream in(entry.path());
    for (std::string line; std::getline(in, line);) {
      std::smatch match;
      if (std::regex_search(line, match, pattern)) {
        found.push_back({fs::relative(entry.path(), root).generic_string(), match[1]});
      }
    }
  }
  return found;
}

std::vector<std::string> forbidden_includes(const fs::path& root) {
  const std::regex quoted(R"re(^\s*#\s*include\s*["<]([^">]+)[">])re");
  std::vector<std::string> problems;
  for (const auto& [folder, allowed] : kAllowed) {
    for (const Include& include :
         includes_below(root, folder.substr(0, folder.find('/')), quoted)) {
      if (folder_of(include.file) != folder || !is_ours(include.included)) continue;
      if (std::ranges::find(allowed, folder_of(include.included)) == allowed.end()) {
        problems.push_back(include.file + " includes " + include.included);
      }
    }
  }
  return problems;
}

}  // namespace

TEST(House, FoldersIncludeOnlyWhatTheyMayUse) {
  const fs::path root = LOCSIM_SOURCE_DIR;
  const std::regex quoted(R"re(^\s*#\s*include\s*["<]([^">]+)[">])re");
  EXPECT_GT(includes_below(root, "localization", quoted).size(), 5U) << "nothing was searched";
  for (const std::string& problem : forbidden_includes(root)) ADD_FAILURE() << problem;
}

TEST(House, AnIncludeOfTheSimulatorInLocalizationIsFound) {
  const fs::path root = fs::path(testing::TempDir()) / "locsim_house";
  for (const auto& [folder, allowed] : kAllowed) fs::create_directories(root / folder);
  std::ofstream(root / "localization" / "leak.cpp") << "#include \"sim/trajectory.h\"\n"
                                                    << "#include <sim/actors.h>\n#include <map>\n";
  std::ofstream(root / "maps" / "build" / "fine.cpp") << "#include \"localization/localizer.h\"\n";
  const std::vector<std::string> problems = forbidden_includes(root);
  fs::remove_all(root);
  EXPECT_EQ(problems, (std::vector<std::string>{"localization/leak.cpp includes sim/trajectory.h",
                                                "localization/leak.cpp includes sim/actors.h"}));
}

TEST(House, HeavyLibrariesStayOutOfHeaders) {
  const fs::path root = LOCSIM_SOURCE_DIR;
  const std::regex angled(R"(^\s*#\s*include\s*<([^>]+)>)");
  for (const char* folder :
       {"core", "maps", "localization", "sim", "scenarios", "render", "apps"}) {
    for (const Include& include : includes_below(root, folder, angled)) {
      if (!include.file.ends_with(".h")) continue;
      for (const std::string& library : kOutOfHeaders) {
        EXPECT_FALSE(include.included.starts_with(library))
            << include.file << " includes " << include.included;
      }
    }
  }
}

TEST(House, OnlyScenariosReadYaml) {
  const fs::path root = LOCSIM_SOURCE_DIR;
  const std::regex yaml(R"(^\s*#\s*include\s*<(yaml-cpp/[^>]+)>)");
  for (const char* folder : {"core", "maps", "localization", "sim", "render"}) {
    for (const Include& include : includes_below(root, folder, yaml)) {
      ADD_FAILURE() << include.file << " includes " << include.included;
    }
  }
}

TEST(House, OnlyAppsPrint) {
  const fs::path root = LOCSIM_SOURCE_DIR;
  const std::regex printing(R"re((std::cout|std::cerr|\bprintf\(|\bputs\())re");
  for (const char* folder : {"core", "maps", "localization", "sim", "scenarios", "render"}) {
    for (const Include& use : includes_below(root, folder, printing)) {
      ADD_FAILURE() << use.file << " uses " << use.included;
    }
  }
}
