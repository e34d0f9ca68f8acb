#include <cmath>
#include <cstdint>
#include <fstream>
#include <limits>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "mlo/core/error.hpp"
#include "mlo/pipeline/config_io.hpp"

namespace mlo {
namespace {

using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;

enum class Kernel { none, huber, cauchy };

struct InnerConfig {
  double gate_m = 1.5;
  Kernel kernel = Kernel::huber;

  template <class Visitor>
  void fields(Visitor& visit) {
    visit("gate_m", gate_m, between(0.0, 10.0), "matches farther apart than this are dropped [m]");
    visit("kernel", kernel,
          Choices<Kernel>{{"none", Kernel::none}, {"huber", Kernel::huber}, {"cauchy", Kernel::cauchy}},
          "robust kernel");
  }
};

struct OuterConfig {
  bool enabled = true;
  int iterations = 20;
  std::uint64_t seed = 7;
  double scale = 0.1;
  std::string label = "plain";
  std::vector<double> weights = {1.0, 2.5};
  InnerConfig inner;

  template <class Visitor>
  void fields(Visitor& visit) {
    visit("enabled", enabled, Anything{}, "a switch");
    visit("iterations", iterations, between(1, 100), "a count");
    visit("seed", seed, at_least(0), "a large number");
    visit("scale", scale, Anything{}, "any number");
    visit("label", label, Anything{}, "a text");
    visit("weights", weights, between(0.0, 5.0), "a list");
    visit.group("inner", inner, "a nested group");
  }
  std::vector<std::string> find_problems() const {
    if (iterations > 50 && !enabled) return {"iterations above 50 need enabled"};
    return {};
  }
};

struct ProgramConfig {
  OuterConfig outer;

  template <class Visitor>
  void fields(Visitor& visit) {
    visit.group("outer", outer, "the outer group");
  }
};

void apply(ProgramConfig& config, const std::string& yaml) {
  apply_yaml(view_config(config), yaml, "file.yaml");
}

/// The message of the InputError that applying the text must throw; fails the test when there is none.
std::string message_of(const std::string& yaml) {
  ProgramConfig config;
  try {
    apply(config, yaml);
  } catch (const InputError& e) {
    return e.what();
  }
  ADD_FAILURE() << "accepted: " << yaml;
  return {};
}

std::string message_of_setting(const std::string& setting) {
  ProgramConfig config;
  try {
    apply_setting(view_config(config), setting);
  } catch (const InputError& e) {
    return e.what();
  }
  ADD_FAILURE() << "accepted: " << setting;
  return {};
}

std::string printed(ProgramConfig config) {
  return to_yaml(view_config(config));
}

TEST(ConfigYaml, ReadsEveryTypeOfValue) {
  ProgramConfig config;
  apply(config, R"(
outer:
  enabled: false
  iterations: 50
  seed: 18446744073709551615
  scale: -1.25e-3
  label: two words
  weights: [0, 0.5, 5]
  inner:
    gate_m: 10
    kernel: cauchy
)");
  EXPECT_FALSE(config.outer.enabled);
  EXPECT_EQ(config.outer.iterations, 50);
  EXPECT_EQ(config.outer.seed, std::numeric_limits<std::uint64_t>::max());
  EXPECT_EQ(config.outer.scale, -1.25e-3);
  EXPECT_EQ(config.outer.label, "two words");
  EXPECT_THAT(config.outer.weights, ElementsAre(0.0, 0.5, 5.0));
  EXPECT_EQ(config.outer.inner.gate_m, 10.0);
  EXPECT_EQ(config.outer.inner.kernel, Kernel::cauchy);
}

TEST(ConfigYaml, LeavesWhatIsNotNamed) {
  ProgramConfig config;
  apply(config, "outer:\n  inner:\n    gate_m: 3\n");
  EXPECT_EQ(config.outer.inner.gate_m, 3.0);
  EXPECT_EQ(config.outer.inner.kernel, Kernel::huber);
  EXPECT_EQ(config.outer.iterations, 20);
}

TEST(ConfigYaml, EmptyTextAndEmptyGroupsChangeNothing) {
  for (const char* const text : {"", "# only a comment\n", "---\n", "outer:\n", "outer:\n  inner: {}\n"}) {
    ProgramConfig config;
    apply(config, text);
    EXPECT_EQ(printed(config), printed({})) << text;
  }
}

TEST(ConfigYaml, PrintedTextReadsBackExactly) {
  ProgramConfig config;
  config.outer.enabled = false;
  config.outer.iterations = 33;
  config.outer.seed = std::numeric_limits<std::uint64_t>::max();
  config.outer.scale = 1.0 / 3.0;
  config.outer.label = "quote \" backslash \\ hash # colon: tab\t newline\n true";
  config.outer.weights.assign(200, 1.0 / 7.0);
  config.outer.inner = {std::nextafter(1.0, 2.0), Kernel::none};
  const std::string text = printed(config);

  ProgramConfig read;
  apply(read, text);
  EXPECT_EQ(printed(read), text);
  EXPECT_EQ(read.outer.scale, config.outer.scale);
  EXPECT_EQ(read.outer.seed, config.outer.seed);
  EXPECT_EQ(read.outer.label, config.outer.label);
  EXPECT_EQ(read.outer.weights, config.outer.weights);
  EXPECT_EQ(read.outer.inner.gate_m, config.outer.inner.gate_m);
  EXPECT_EQ(read.outer.inner.kernel, Kernel::none);
}

TEST(ConfigYaml, PrintsDocumentationRangesAndValues) {
  EXPECT_EQ(printed({}), R"(# the outer group
outer:
  # a switch (true or false)
  enabled: true
  # a count (1 to 100)
  iterations: 20
  # a large number (at least 0)
  seed: 7
  # any number
  scale: 0.1
  # a text
  label: "plain"
  # a list (0 to 5)
  weights: [1.0, 2.5]

  # a nested group
  inner:
    # matches farther apart than this are dropped [m] (0 to 10)
    gate_m: 1.5
    # robust kernel (one of none, huber, cauchy)
    kernel: huber
)");
}

TEST(ConfigYaml, WrapsLongLines) {
  ProgramConfig config;
  config.outer.weights.assign(100, 1.25);
  std::istringstream lines(printed(config));
  for (std::string line; std::getline(lines, line);) EXPECT_LE(line.size(), 110U) << line;
}

TEST(ConfigYaml, UnknownKeysNameTheLineAndTheNearestKey) {
  EXPECT_EQ(message_of("outer:\n  iterations: 3\n  iteratoins: 4\n"),
            "file.yaml:3: unknown key 'outer.iteratoins'; did you mean 'outer.iterations'?");
  EXPECT_THAT(message_of("outter:\n  iterations: 3\n"), HasSubstr("file.yaml:1: unknown key 'outter'"));
  EXPECT_THAT(message_of("outter: 1\n"), HasSubstr("did you mean 'outer'?"));
  EXPECT_THAT(message_of("outer:\n  gate_m: 1\n"), HasSubstr("did you mean 'outer.inner.gate_m'?"));
  EXPECT_THAT(message_of("outer:\n  zzzzzzzzzzzz: 1\n"),
              AllOf(HasSubstr("'mlo config' lists all keys"), Not(HasSubstr("did you mean"))));
}

TEST(ConfigYaml, WrongTypesNameKeyValueAndLine) {
  EXPECT_EQ(message_of("outer:\n  iterations: many\n"),
            "file.yaml:2: outer.iterations: 'many' is not a whole number; allowed: 1 to 100");
  EXPECT_THAT(message_of("outer:\n  iterations: 2.5\n"), HasSubstr("'2.5' is not a whole number"));
  EXPECT_THAT(message_of("outer:\n  seed: -1\n"),
              HasSubstr("'-1' is not a whole number; allowed: at least 0"));
  EXPECT_THAT(message_of("outer:\n  scale: 1 m\n"), HasSubstr("'1 m' is not a number"));
  EXPECT_THAT(message_of("outer:\n  enabled: yes\n"), HasSubstr("'yes' is not true or false"));
  EXPECT_THAT(message_of("outer:\n  iterations: [1]\n"), HasSubstr("needs one value, not a list"));
  EXPECT_THAT(message_of("outer:\n  iterations: {a: 1}\n"), HasSubstr("needs a value, not keys"));
  EXPECT_THAT(message_of("outer:\n  iterations:\n"),
              HasSubstr("file.yaml:2: outer.iterations: needs a value"));
  EXPECT_THAT(message_of("outer:\n  weights: 1.0\n"), HasSubstr("needs a list, as in [1.0, 2.0]"));
  EXPECT_THAT(message_of("outer:\n  weights: [1.0, [2.0]]\n"), HasSubstr("needs a list of numbers"));
  EXPECT_THAT(message_of("outer:\n  inner:\n    kernel: hubert\n"),
              HasSubstr("outer.inner.kernel: 'hubert' is not one of none, huber, cauchy"));
  EXPECT_THAT(message_of("outer: 5\n"), HasSubstr("file.yaml:1: 'outer' must hold 'key: value' lines"));
  EXPECT_THAT(message_of("[1, 2]\n"), HasSubstr("a configuration must hold 'key: value' lines"));
}

TEST(ConfigYaml, ValuesOutOfRangeNameTheRange) {
  EXPECT_EQ(message_of("outer:\n  iterations: 0\n"),
            "file.yaml:2: outer.iterations: 0 is out of range; allowed: 1 to 100");
  EXPECT_THAT(message_of("outer:\n  iterations: 99999999999\n"), HasSubstr("is not a whole number"));
  EXPECT_THAT(message_of("outer:\n  weights: [1, 5.1]\n"),
              HasSubstr("outer.weights: element 2: 5.1 is out of range; allowed: 0 to 5"));
}

TEST(ConfigYaml, RejectsWhatIsNotFinite) {
  for (const char* const value : {"nan", ".nan", "NaN", "-nan", "inf", ".inf", "-inf", "1e999"}) {
    EXPECT_THAT(message_of(std::string("outer:\n  scale: ") + value + "\n"), HasSubstr("outer.scale"))
        << value;
    EXPECT_THAT(message_of(std::string("outer:\n  inner:\n    gate_m: ") + value + "\n"), HasSubstr("gate_m"))
        << value;
    EXPECT_THAT(message_of(std::string("outer:\n  weights: [1, ") + value + "]\n"), HasSubstr("weights"))
        << value;
  }
}

TEST(ConfigYaml, RejectsRepeatedKeysBrokenTextAndSeveralDocuments) {
  EXPECT_EQ(message_of("outer:\n  iterations: 3\n  iterations: 4\n"),
            "file.yaml:3: 'outer.iterations' is given twice");
  EXPECT_THAT(message_of("outer:\n  weights: [1, 2\n"), HasSubstr("not valid YAML"));
  EXPECT_THAT(message_of("a: b: c\n"), HasSubstr("file.yaml:1: not valid YAML"));
  EXPECT_THAT(message_of("outer: {}\n---\nouter: {}\n"), HasSubstr("2 YAML documents"));
  EXPECT_THAT(message_of("[a]: 1\n"), HasSubstr("a key must be a word"));
}

TEST(ConfigYaml, FilesThatCannotBeReadAreNamed) {
  ProgramConfig config;
  const ConfigView view = view_config(config);
  for (const std::string& path : {std::string("/no/such/file.yaml"), testing::TempDir()}) {
    try {
      apply_yaml_file(view, path);
      FAIL() << path;
    } catch (const InputError& e) {
      EXPECT_THAT(e.what(), AllOf(HasSubstr(path), HasSubstr("cannot be read")));
    }
  }
}

TEST(ConfigYaml, FilesAreNamedInMessages) {
  const std::string path = testing::TempDir() + "/mlo_bad_config.yaml";
  std::ofstream(path) << "outer:\n  iterations: 0\n";
  ProgramConfig config;
  try {
    apply_yaml_file(view_config(config), path);
    FAIL();
  } catch (const InputError& e) {
    EXPECT_THAT(e.what(), HasSubstr(path + ":2: outer.iterations"));
  }
}

TEST(ConfigSetting, ChangesOneValue) {
  ProgramConfig config;
  const ConfigView view = view_config(config);
  apply_setting(view, "outer.iterations=21");
  apply_setting(view, "outer.inner.kernel=none");
  apply_setting(view, "outer.label=a=b # c");
  apply_setting(view, "outer.weights=[3, 4]");
  EXPECT_EQ(config.outer.iterations, 21);
  EXPECT_EQ(config.outer.inner.kernel, Kernel::none);
  EXPECT_EQ(config.outer.label, "a=b # c");
  EXPECT_THAT(config.outer.weights, ElementsAre(3.0, 4.0));
  apply_setting(view, "outer.weights=[]");
  apply_setting(view, "outer.label=");
  EXPECT_THAT(config.outer.weights, IsEmpty());
  EXPECT_EQ(config.outer.label, "");
}

TEST(ConfigSetting, SaysWhatIsWrong) {
  EXPECT_EQ(message_of_setting("outer.iteratons=3"),
            "--set outer.iteratons=3: unknown key 'outer.iteratons'; did you mean 'outer.iterations'?");
  EXPECT_THAT(message_of_setting("outer.iterations=0"), HasSubstr("allowed: 1 to 100"));
  EXPECT_THAT(message_of_setting("outer.iterations="), HasSubstr("'' is not a whole number"));
  EXPECT_THAT(message_of_setting("outer.iterations"), HasSubstr("write key=value"));
  EXPECT_THAT(message_of_setting("=3"), HasSubstr("write key=value"));
  EXPECT_THAT(message_of_setting(""), HasSubstr("write key=value"));
  EXPECT_THAT(message_of_setting("outer.inner=3"), HasSubstr("'outer.inner' is a group"));
  EXPECT_THAT(message_of_setting("outer.weights=[1,"), HasSubstr("not a list"));
  EXPECT_THAT(message_of_setting("outer.weights=3"), HasSubstr("needs a list"));
  EXPECT_THAT(message_of_setting("outer.weights="), HasSubstr("needs a value"));
}

TEST(ConfigSetting, LeavesTheValueWhenItIsWrong) {
  ProgramConfig config;
  const ConfigView view = view_config(config);
  EXPECT_THROW(apply_setting(view, "outer.iterations=0"), InputError);
  EXPECT_THROW(apply_setting(view, "outer.weights=[1, 9]"), InputError);
  EXPECT_EQ(config.outer.iterations, 20);
  EXPECT_THAT(config.outer.weights, ElementsAre(1.0, 2.5));
}

TEST(ConfigProblems, DefaultsHaveNone) {
  ProgramConfig config;
  EXPECT_THAT(find_problems(view_config(config)), IsEmpty());
}

TEST(ConfigProblems, ListsEveryValueAndRule) {
  ProgramConfig config;
  config.outer.iterations = 101;
  config.outer.enabled = false;
  config.outer.scale = std::numeric_limits<double>::quiet_NaN();
  config.outer.weights = {1.0, std::numeric_limits<double>::infinity()};
  config.outer.inner.gate_m = -1.0;
  config.outer.inner.kernel = static_cast<Kernel>(9);
  EXPECT_THAT(find_problems(view_config(config)),
              ElementsAre("outer.iterations: 101 is out of range; allowed: 1 to 100",
                          "outer.scale: .nan is out of range; allowed: finite numbers",
                          "outer.weights: element 2: .inf is out of range; allowed: 0 to 5",
                          "outer.inner.gate_m: -1.0 is out of range; allowed: 0 to 10",
                          "outer.inner.kernel: has no name; allowed: one of none, huber, cauchy",
                          "outer: iterations above 50 need enabled"));
}

TEST(Nearest, CountsASwapAsOneSlip) {
  EXPECT_EQ(nearest("ab", {"xy", "ba"}), "ba");
  EXPECT_EQ(nearest("rnigs", {"rags", "rings"}), "rings");
}

TEST(Nearest, IsEmptyWhenNothingIsNear) {
  EXPECT_EQ(nearest("abc", {}), "");
  EXPECT_EQ(nearest("velodyne", {"ouster", "hesai"}), "");
  EXPECT_EQ(nearest("", {"longer"}), "");
}

TEST(Nearest, ComparesWholeKeysBeforeLastParts) {
  EXPECT_EQ(nearest("mapping.gate", {"odometry.gate_m", "mapping.gate_m"}), "mapping.gate_m");
  EXPECT_EQ(nearest("size", {"a.other", "a.size"}), "a.size");
}

}  // namespace
}  // namespace mlo
