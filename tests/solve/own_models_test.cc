// The models of this project are a suite of `mjcf-pdg regress`: statuses, σ to a thousandth and
// queries to a twentieth are what they were. What gets better is accepted by its --update.
#include <gmock/gmock.h>

#include "tests/support/cli_test.h"

namespace mjcf_pdg::test {
namespace {

using OwnModelsTest = CliTest;

TEST_F(OwnModelsTest, AreSolvedAsWellAndAsCheaplyAsBefore) {
  const Outcome outcome = Run({"regress", std::string(MJCF_PDG_SOURCE_DIR) + "/models/pdg.json"});
  EXPECT_EQ(outcome.exit_code, 0) << outcome.out << outcome.err;
  EXPECT_THAT(outcome.out, testing::HasSubstr(" rows, 0 regressions"));
  EXPECT_THAT(outcome.out, testing::Not(testing::HasSubstr("\n0 rows")));
}

}  // namespace
}  // namespace mjcf_pdg::test
