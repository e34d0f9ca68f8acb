#include <cstdlib>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "apps/program.hpp"
#include "report/run_files.hpp"

namespace mlo {
namespace {

using testing::HasSubstr;

constexpr const char* kNoBrowser =
    "Chromium is not installed (Debian: chromium), so that the page cannot be looked at";

bool has_browser() {
  return std::system("command -v chromium > /dev/null 2>&1") == 0;
}

/// What the browser prints with these options for a page.
std::string browse(const std::filesystem::path& folder, const std::string& options,
                   const std::filesystem::path& page) {
  const std::filesystem::path out = folder / "browser.out";
  const std::string command = "HOME='" + folder.string() +
                              "' timeout 120 chromium --headless --no-sandbox --disable-gpu --no-first-run "
                              "--hide-scrollbars " +
                              options + " 'file://" + page.string() + "' > '" + out.string() +
                              "' 2> /dev/null";
  EXPECT_EQ(std::system(command.c_str()), 0);
  return read_text(out);
}

TEST(Report, IsReadInABrowser) {
  const test::TempFolder folder;
  const std::string first = test::write_run(folder, "first").string();
  const std::string second = test::write_run(folder, "second").string();
  const std::filesystem::path page = folder.path() / "report.html";
  const ProgramRun run =
      run_program({"report", first, second, "--truth", first + "/trajectory.txt", "--out", page.string()});
  ASSERT_EQ(run.exit_code, 0) << run.err;
  EXPECT_THAT(run.out, HasSubstr("2 runs"));
  if (!has_browser()) GTEST_SKIP() << kNoBrowser;

  // The document as the browser understood it: everything closed, pictures within it.
  const std::string document = browse(folder.path(), "--dump-dom", page);
  EXPECT_THAT(document,
              testing::AllOf(HasSubstr("<h2>Warnings</h2>"), HasSubstr("Position error after alignment"),
                             HasSubstr("something &lt;odd&gt;"), testing::EndsWith("</html>\n")));
  // A picture of it holds more than that of an empty page.
  const std::filesystem::path empty = folder.write("empty.html", "<!DOCTYPE html><title>empty</title>");
  const auto picture = [&](const std::filesystem::path& what) {
    const std::filesystem::path file = folder.path() / "picture.png";
    browse(folder.path(), "--window-size=1400,3000 --screenshot='" + file.string() + "'", what);
    return read_text(file);
  };
  const std::string of_report = picture(page);
  EXPECT_THAT(of_report, HasSubstr("PNG"));
  EXPECT_GT(of_report.size(), 3 * picture(empty).size());
  const std::filesystem::path print = folder.path() / "print.pdf";
  browse(folder.path(), "--print-to-pdf='" + print.string() + "'", page);
  EXPECT_THAT(read_text(print), testing::StartsWith("%PDF"));
}

TEST(Report, AFolderThatIsNoRunIsNamed) {
  const test::TempFolder folder;
  const ProgramRun run = run_program({"report", folder.path().string()});
  EXPECT_EQ(run.exit_code, 1);
  EXPECT_THAT(run.err, HasSubstr("run.json"));
  EXPECT_EQ(run_program({"report"}).exit_code, 2);
}

}  // namespace
}  // namespace mlo
