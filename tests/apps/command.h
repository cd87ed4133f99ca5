#pragma once

#include <gtest/gtest.h>
#include <sys/wait.h>

#include <algorithm>
#include <array>
#include <cstdio>
#include <filesystem>
#include <string>

namespace locsim::apps {

struct Answer {
  int exit_code = -1;
  /// Standard output and standard error.
  std::string text;
};

/// Runs the command itself.
inline Answer locsim(const std::string& arguments) {
  const std::string command = std::string(LOCSIM_COMMAND) + " " + arguments + " 2>&1 </dev/null";
  Answer answer;
  FILE* pipe = popen(command.c_str(), "r");
  std::array<char, 4096> buffer{};
  while (const std::size_t n = std::fread(buffer.data(), 1, buffer.size(), pipe)) {
    answer.text.append(buffer.data(), n);
  }
  const int status = pclose(pipe);
  if (WIFEXITED(status)) answer.exit_code = WEXITSTATUS(status);
  return answer;
}

/// What the command says to arguments that it must refuse: exit code 2, one line of error.
inline std::string refusal_of(const std::string& arguments) {
  const Answer answer = locsim(arguments);
  EXPECT_EQ(answer.exit_code, 2) << answer.text;
  EXPECT_TRUE(answer.text.starts_with("error: ")) << answer.text;
  EXPECT_EQ(std::ranges::count(answer.text, '\n'), 1) << answer.text;
  return answer.text;
}

/// A test with a scratch folder of its own.
class InScratchFolder : public testing::Test {
 protected:
  InScratchFolder() {
    const auto* info = testing::UnitTest::GetInstance()->current_test_info();
    folder_ = std::filesystem::path(testing::TempDir()) /
              ("locsim_" + std::string(info->test_suite_name()) + "_" + info->name());
    std::filesystem::remove_all(folder_);
    std::filesystem::create_directories(folder_);
  }
  ~InScratchFolder() override { std::filesystem::remove_all(folder_); }

  [[nodiscard]] std::filesystem::path out() const { return folder_ / "out"; }

  std::filesystem::path folder_;
};

}  // namespace locsim::apps
