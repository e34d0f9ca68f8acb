#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "mlo/core/error.hpp"
#include "mlo/reproduction/paper_tables.hpp"

namespace mlo {
namespace {

const PaperTable& table_of(const PaperTables& tables, const std::string& name) {
  for (const PaperTable& table : tables.tables) {
    if (table.name == name) return table;
  }
  throw std::runtime_error("no table " + name);
}

// Mean of a column over the rows that did not fail.
double mean_of(const PaperTable& table, std::size_t method, std::size_t measure,
               const std::string& left_out = "") {
  double sum = 0.0;
  std::size_t count = 0;
  for (const PaperRow& row : table.rows) {
    const std::optional<double> value = row.values[method][measure];
    if (!value || row.name == left_out) continue;
    sum += *value;
    ++count;
  }
  return sum / static_cast<double>(count);
}

// The means that the paper prints below its columns follow from the rows: no digit was mistyped.
TEST(PaperTables, MeansAreThoseOfThePaper) {
  const PaperTables tables = paper_tables();
  const PaperTable& first = table_of(tables, "Table I");
  EXPECT_NEAR(mean_of(first, 0, 0, "02"), 4.69, 0.006);
  EXPECT_NEAR(mean_of(first, 2, 0, "02"), 7.43, 0.006);
  EXPECT_NEAR(mean_of(first, 3, 0, "02"), 3.83, 0.006);   // printed as 3.88
  EXPECT_NEAR(mean_of(first, 4, 0, "02"), 3.605, 0.006);  // printed as 3.66
  const PaperTable& second = table_of(tables, "Table II");
  EXPECT_NEAR(mean_of(second, 0, 0), 1.41, 0.006);
  EXPECT_NEAR(mean_of(second, 2, 0), 1.03, 0.006);
  EXPECT_NEAR(mean_of(second, 2, 1), 0.10, 0.006);
  EXPECT_NEAR(mean_of(second, 2, 2), 0.13, 0.006);
  const PaperTable& fourth = table_of(tables, "Table IV");
  EXPECT_NEAR(mean_of(fourth, 0, 0), 1.16, 0.006);
  EXPECT_NEAR(mean_of(fourth, 1, 0), 0.22, 0.006);
  EXPECT_NEAR(mean_of(fourth, 2, 0), 0.19, 0.006);
  EXPECT_NEAR(mean_of(fourth, 2, 1), 0.17, 0.007);
  EXPECT_NEAR(mean_of(fourth, 2, 2), 2.19, 0.009);
}

TEST(PaperTables, EveryTableHasItsRows) {
  const PaperTables tables = paper_tables();
  EXPECT_THAT(tables.source, testing::HasSubstr("Tables I to IV"));
  EXPECT_EQ(table_of(tables, "Table I").rows.size(), 11U);
  EXPECT_EQ(table_of(tables, "Table II").rows.size(), 9U);
  EXPECT_EQ(table_of(tables, "Table III").rows.size(), 1U);
  EXPECT_EQ(table_of(tables, "Table IV").rows.size(), 13U);
  EXPECT_EQ(table_of(tables, "Fig. 7").rows.size(), 2U);
}

TEST(PaperTables, MistakesAreNamed) {
  const std::string head =
      "source: s\ntables:\n  - {name: T, caption: c, data: d, measures: [a], methods: [m, n], rows: {";
  EXPECT_NO_THROW(parse_paper_tables(head + "x: [[1], [fail]]}}"));
  const auto problem_of = [](const std::string& yaml) {
    try {
      parse_paper_tables(yaml);
    } catch (const InputError& error) {
      return std::string(error.what());
    }
    return std::string("no error");
  };
  EXPECT_THAT(problem_of(head + "x: [[1]]}}"), testing::HasSubstr("1 entries for 2 methods"));
  EXPECT_THAT(problem_of(head + "x: [[1], [1, 2]]}}"), testing::HasSubstr("2 values for 1 measures"));
  EXPECT_THAT(problem_of(head + "x: [[1], [two]]}}"), testing::HasSubstr("tables of the paper"));
  EXPECT_THAT(problem_of("source: ["), testing::HasSubstr("tables of the paper"));
}

}  // namespace
}  // namespace mlo
