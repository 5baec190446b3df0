// Every claim of the independent check comes with a proof, and the proofs hold.
#include "verify/convex/certificate.h"

#include <algorithm>
#include <cmath>

#include "tests/support/pose_trials.h"
#include "tests/support/test_support.h"

namespace mjcf_pdg::test {
namespace {

class CertificateTest : public MujocoTest {};

TEST_F(CertificateTest, EveryClaimAboutTenThousandPosesHasAProof) {
  const PoseTrials trials = RunPoseTrials(10000, 1);
  EXPECT_EQ(trials.wrong_count, 0);
  for (const std::string& wrong : trials.wrong) ADD_FAILURE() << wrong;
  for (const PoseTally* tally : {&trials.random, &trials.aligned, &trials.near}) {
    EXPECT_GT(tally->free, tally->poses / 10);
    EXPECT_GT(tally->overlapping, tally->poses / 10);
    EXPECT_LT(tally->unproven, 1e-3 * tally->poses);
  }
}

}  // namespace
}  // namespace mjcf_pdg::test
