// The numbers by which a solve is tuned: what each is for and its unit, all in one place.
//
// None of them decides whether an answer is right, which is the verifier's matter; they decide how
// soon and how near an answer is found. How they were chosen: bench/sensitivity.py halves and
// doubles each of them on random problems of several robots and tells what that changes in success,
// σ and work (bench/README.md, Sensitivity); where more was measured, it stands beside the number.
// How far a search goes at each effort stands in problem/effort.h. Accuracies that an algorithm
// needs to be correct stand beside the algorithm.
//
// Units: [size] is the scene's size (Problem::size), [tolerance] the user's (Options::tolerance),
// [1] a ratio. Lengths are never absolute, so that a scaled scene is solved alike.
#ifndef MJCF_PDG_SRC_BASE_TUNING_H_
#define MJCF_PDG_SRC_BASE_TUNING_H_

#include <cstddef>

namespace mjcf_pdg::tuning {

// How accurate distances are taken to be (problem/workspace.cc, Tolerances).
namespace accuracy {
// Distances of convex geoms repeat up to this [size]: those to cylinders and ellipsoids, which come
// from iterations, scattered by up to 5e-7 m in scenes of 0.1 m.
inline constexpr double kDistanceJitter = 6e-6;
// How much of the tolerance a descent leaves unused [tolerance]. MuJoCo's multi-contact finds
// overlaps that are up to 0.6 tolerances deeper than the distance says: at 0.2 it disputed two of
// 600 answers, at 0.5 none.
inline constexpr double kAimInside = 0.5;
// Exact meshes are kept this far apart [size]; of 1e-6 to 1e-5 the quickest.
inline constexpr double kMeshGap = 2e-6;
}  // namespace accuracy

// One linearized step of the local optimization (optimize/linearized_step.cc).
namespace step {
// Pairs that get rows, the nearest if there are more: so many, or as many as there are degrees of
// freedom where these are more, for so many contacts may hold an optimum.
inline constexpr int kContacts = 48;
inline constexpr double kSamePoint = 1e-3;    // witness points nearer than this are the same [size]
inline constexpr double kLimitReach = 0.5;    // limits of turns farther than this get no row [rad]
inline constexpr double kSlideReach = 5.0;    // ... limits of slides [size]
inline constexpr double kLimitPenalty = 1e6;  // μ of joint limits: so stiff that none gives way [m]
inline constexpr double kLargestTurn = 1.0;   // of a joint in a step; linear no farther [rad]
inline constexpr int kLcpStepsPerVariable = 10;  // pivots of the LCP, per row and degree of freedom
// A row is packed at the cost of so many of its entries [1]; where that is less than those that
// packing leaves out, rows are packed. 8, 16 and 24 took as many instructions (heaps of 8 bodies,
// chains of 30 and 50 links; a hand 1 % fewer with 24), 48 up to 7 % more.
inline constexpr int kPackingCost = 24;
inline constexpr double kLcpTolerance = 0.01;  // violation of a row that counts as 0 [tolerance]
}  // namespace step

// The descent from a start to a local optimum (optimize/local_optimization.cc).
namespace descent {
// Steps of a descent from a usual start, from a start that only seeks another optimum, and of the
// last descent that polishes an answer; the relative decrease of σ below which each has settled
// [1]; the longest step of the first two and of the last [√σ, m, in scenes up to desk size]; and
// steps without a lower σ after which exact meshes end it.
inline constexpr int kSteps = 60, kCoarseSteps = 40, kPolishSteps = 15;
inline constexpr double kConvergence = 1e-4, kCoarseConvergence = 1e-3, kPolishConvergence = 1e-6;
inline constexpr double kTrustRadius = 0.3, kPolishRadius = 0.05;
inline constexpr int kLastChances = 4, kPolishChances = 3;
// μ, the penalty weight of contacts that cannot be held [m], in scenes up to desk size; it grows
// with larger ones. It begins at the first value and is raised tenfold as long as an overlap
// remains.
inline constexpr double kFirstPenalty = 10.0, kHighestPenalty = 1e4;
inline constexpr double kDeskSize = 0.1;      // the size of a scene on a desk [m]
inline constexpr double kSizePerDepth = 0.1;  // a scene is taken as no smaller than this [overlap]
// The penalty weight by which a step is judged, over the largest contact force [1]: by μ, far above
// it, a micrometre of overlap would outweigh all that σ can gain.
inline constexpr double kPenaltyOverForce = 3.0;

// The trust region and the damping.
inline constexpr double kFullStep = 0.9;      // a step this long may double the radius [radius]
inline constexpr double kLeastRadius = 1e-6;  // the descent ends where the radius is less [size]
// Levenberg-Marquardt damping of H [1], at first, the least above 0, and what it is at least when
// it is raised again. A step that keeps more than kKept of the decrease of merit that it promised
// divides it by ten, one that keeps less than kBroken multiplies it by ten.
inline constexpr double kFirstDamping = 0.1, kLeastDamping = 1e-5, kRenewedDamping = 1e-4;
inline constexpr double kKept = 0.75, kBroken = 0.25;
// Where several trees move and many contacts are curved, each step that lowers σ leaves some tree
// in a small overlap, and all the others wait for it. After so many steps in a row without a free
// iterate, a step that ends with overlaps below this [size] raises the damping, too, until little
// is left of a step but that it parts them. Of ten heaps of 60 bodies first descents took 28 steps
// on average; without the rule 55, and two did not end free. After 5 and 20 steps it is 25 and 33.
// Below 1e-4 it is 42 and σ 3 % less, below 1e-2 20 and 2 % more; of the answers σ differs by half
// as much. Heaps of 20 and 40 bodies differ less.
inline constexpr int kDrifts = 10;
inline constexpr double kNearlyFree = 1e-3;

// The distance within which pairs get rows [size]: at the start, and after a step 1.5 times its
// length within these bounds.
inline constexpr double kFirstMargin = 0.12, kLeastMargin = 0.01, kLargestMargin = 0.5;
inline constexpr double kMarginPerStep = 1.5;

// When a descent ends.
inline constexpr double kSmallStep = 1e-6, kSmallShare = 1e-4;  // a small step [size] + [√σ]
inline constexpr int kSettled = 2;  // steps in a row that hardly change σ, where it is free
// After so many steps without a better iterate it goes back to the best one; sooner with exact
// meshes, for each of their steps adds the planes of its contacts to the next step's constraints.
inline constexpr int kPatience = 7, kPatienceWithPlanes = 1;
// It is given up as hopeless after kHopeless steps in a row that predict a σ above
// LocalOptions::give_up_sigma, even if the next step's falls by as much as theirs did. A descent
// that still overlaps is judged from step kGiveUpFrom on. Of 14,755 later starts of nine robots 355
// would have ended at something nearer; with these rules 279 did for 7.2 queries a start, without
// the next step's fall 246 for 6.6, without giving up all for 12.8.
inline constexpr int kHopeless = 2, kGiveUpFrom = 4;
// It ends near a known optimum: within this distance of it [√σ of the optimum], unless the step
// predicts a σ below kBeatsKnown of its [1], for then it may lead elsewhere.
inline constexpr double kNearKnown = 0.15, kBeatsKnown = 0.95;

// Exact meshes.
inline constexpr double kUnseenOverlap = 1e-3;  // counted for an overlap of unknown depth [size]
// They keep a safety margin from the planes that bound a step, for curved surfaces meet before
// their planes do: after a step into an overlap, this many times the overlap [1], at most this
// share of the step's length [1]; after a free step this share of the margin is kept [1].
inline constexpr double kSafetyMarginPerOverlap = 2.0, kSafetyMarginPerStep = 0.03;
inline constexpr double kSafetyMarginKept = 0.25;
// A step that ends in an overlap is made again, at this share of its length [1]: the first time a
// long one, since what the overlap taught may suffice, then the shorter one.
inline constexpr double kFirstShortened = 0.7, kShortened = 0.15;
}  // namespace descent

// The starts of a search (start/selection.cc, search/varied_starts.cc, search/trials.cc).
namespace starts {
// Spreads of the noisy starts in turn, since how far the basin of the nearest answer reaches is not
// known [√σ of the best answer].
inline constexpr double kNoise[] = {5.0, 2.0, 3.0, 8.0};
inline constexpr double kHopSpreads[] = {3.0, 7.5, 1.5};  // ... of contact hops, one at random
inline constexpr double kLeastNoise = 0.01;               // √σ that noise assumes at least [size]
inline constexpr double kWiderWhenBlind = 0.5;  // spread added with every try while nothing is free
inline constexpr double kLeastGain =
    1e-3;                            // dofs that the norm hardly sees count as this [rms gain]
inline constexpr int kHopEvery = 3;  // every third of the varied starts is a hop
inline constexpr double kHoppable = 20.0;  // a pair nearer than this may be hopped over [tolerance]
inline constexpr double kUniformReach = 10.0;  // how far a start anywhere slides from q_in [size]
// Motion coherence: frames that are kept, since longer motions seldom come back to where they were,
// and the nearest of them that a start looks at.
inline constexpr std::size_t kFramesKept = 64, kFramesTried = 8;
// A start that predicts a σ this many times the best one's is given up [1].
inline constexpr double kGiveUp = 1.15;

// The first free configuration on a ray from q_in is sought at growing shares of the way [1], then
// by halving.
inline constexpr double kFirstOnRay = 1.0 / 256.0, kNextOnRay = 1.2;
inline constexpr int kRayHalvings = 2;
inline constexpr double kRayEnd = 4.0;         // a ray ends this many times as far as its start [1]
inline constexpr double kWorthARay = 2.0;      // σ at which a ray is left, over the least found [1]
inline constexpr double kWorthADescent = 5.0;  // ... over the best answer's σ [1]
}  // namespace starts

// Starts for meshes as triangles (search/exact_mesh_starts.cc, start/pair_by_pair.cc).
namespace exact_meshes {
// A trajectory's last answer is followed while √σ is below this many times what the nearest can
// have at least [1], for this many frames in a row.
inline constexpr double kFollowed = 2.0;
inline constexpr int kFramesFollowed = 5;
// Answers this far, over the depth to which meshes overlap at q_in [1], may well have a nearer one.
inline constexpr double kFar = 2.5, kVeryFar = 10.0;
// Exact meshes may make this many times the queries of an effort [1], since most of theirs only ask
// whether a configuration is free; and this many while the answer is very far.
inline constexpr double kQueries = 1.5, kQueriesVeryFar = 3.0;
// Then the short way out of the overlap is tried with patience: tries, steps of a try, and the
// noise about q_in with which a try begins [depth].
inline constexpr int kWaysOut = 5, kPatientSteps = 120;
inline constexpr double kNudge = 0.2;
inline constexpr int kHintChances = 2;  // LocalOptions::last_chances of a start near its answer

// Pair by pair: rounds over all pairs, since parting one may bring others together; the reach that
// is tried first and then doubled, and the largest [size]; halvings back to the first free.
inline constexpr int kRounds = 3, kBisections = 3;
inline constexpr double kFirstReach = 0.02, kLargestReach = 4.0;
}  // namespace exact_meshes

// How a configuration is brought onto the equality constraints (equality/).
namespace equality {
// Residuals are brought below this [m or rad]: a hundredth of what is accepted.
inline constexpr double kAim = 1e-8;
inline constexpr int kProjectionSteps = 30;  // Gauss-Newton; from nearby two or three are enough
inline constexpr double kLargestTurn = 0.5;  // of a joint in one of them [rad]
// Constraints that depend on each other are recognized by singular values below this share of the
// largest [1].
inline constexpr double kRank = 1e-9;
}  // namespace equality

// Following an optimum from one command to the next (track/). Measured by bench/track_bench.
namespace track {
// Steps of a tick's descent from the last answer where that is free; where it is not; and of one
// that keeps distances in full, where the verifier refuses what the first found.
inline constexpr int kFollowSteps = 2, kRepairSteps = 8, kRetreatSteps = 4;
// The first for frames of a trajectory, which lie farther apart; and how often so many follow while
// nothing nearer is found.
inline constexpr int kFrameSteps = 3, kMoreFrameSteps = 2;
// A step that is free, hardly damped, and leads to the σ that it promised, both up to this share
// [1], is enough for a tick: the second one found no lower Σσ and cost a query. So many more
// correct a step that ended in an overlap.
inline constexpr double kEnough = 0.01;
inline constexpr int kCorrections = 2;
// An answer moves by at most this many times what the command moved [1], and this [size], in steps
// of the descent; farther than the second number times, it has jumped.
inline constexpr double kReach = 6.0, kNoise = 1e-5, kJump = 8.0;
// Pairs within this have rows in a tick's descent [size]; a quarter of the usual, since it is
// short.
inline constexpr double kMargin = 0.03;
// Queries of a tick that are kept for the verifier, and the fewest that leave something to follow
// with.
inline constexpr int kReserve = 2, kFewestQueries = 6;
// Queries for another optimum, each a step of the descent beside, in a tick where σ rises and where
// it falls: as the own optimum gets worse another becomes the nearer one. One in either gave a Σσ
// over that of solves of up to 1.15 for a median tick as dear (bench/README.md, track_bench).
inline constexpr double kSearchRising = 4.0 / 3.0, kSearchFalling = 0.5;
// By less than this share σ neither rises nor falls [1]; then another optimum may come nearer, too.
inline constexpr double kFalls = 1e-6;
// Steps of a descent of that search: of those that beat the present answer nine in ten had done so
// by then, and those that do not become free go on to the end.
inline constexpr int kSearchSteps = 8;
// A way that leads no farther than this share of it is blocked [1]; then no other optimum is sought
// for so many ticks, a tenth of a second at 1 kHz.
inline constexpr double kLeastShare = 1e-3;
inline constexpr int kBlocked = 100;
}  // namespace track

// Where max_step limits steps (track/limited_steps.cc): bench/README.md, track_bench.
namespace limited {
// A straight way of no more ticks than this is tried without looking ahead.
inline constexpr double kStraight = 8.0;
// One of no more ticks than this is first tried along what is in the way.
inline constexpr double kSlides = 64.0;
// To slide leads nearer if it does by this share of what the straight way would [1].
inline constexpr double kNearer = 0.1;
// Another way pays if what σ is larger along it than on this side is less than so many times what σ
// is smaller at its end [1].
inline constexpr double kPays = 4.0;
}  // namespace limited

// The way round what is in the way then (track/detour.cc).
namespace detour {
// Nodes of a tree, which four queries a tick fill in a quarter of a second or more; points of the
// trail of either end; and of a way, which is made of a branch and a trail of either, and grows at
// both ends.
inline constexpr int kNodes = 1024, kTrail = 256, kPoints = 2 * kNodes + 4 * kTrail;
// An edge is as long as this many ticks' steps, or this share of the distance between the ends
// where that is longer [1].
inline constexpr double kTicks = 8.0, kShare = 1.0 / 16.0;
// Edges that turn out to be blocked are halved in the next trees, down to so many ticks' steps.
inline constexpr double kFewestTicks = 2.0;
// Samples lie in a box around the middle between the ends. Its half width is this many times their
// distance at first [1], and grows by as much every so many samples.
inline constexpr double kWidth = 0.5;
inline constexpr int kSamplesPerWidth = 16;
// A joint that hardly differs between the ends, by less than this share of what the one does that
// differs most, is left alone in three of four samples [1].
inline constexpr double kStill = 0.05, kStillMoves = 0.25;
}  // namespace detour

// Scenes of several trees (solve/island_search.cc).
namespace islands {
// A scene of no more movable trees than this is solved as a whole: to make and solve islands then
// costs as much (two boxes that overlap among 8: 0.50 ms against 0.48) or more (a hand of four
// fingers and a cube: 0.93 ms a pose against 0.79), and islands that are met for the first time
// take memory [trees].
inline constexpr int kFew = 8;
// A tree nearer to an island's answer than this touches it [tolerance]: as for contact hops.
inline constexpr double kTouching = starts::kHoppable;
// A larger island is solved where a descent in it lowers σ below this share of what it was [1].
inline constexpr double kHelps = 0.99;
// So many islands are kept for later solves: each needs memory of its own. Objects that a robot
// handles come in few combinations.
inline constexpr std::size_t kKept = 8;
}  // namespace islands

// All frames of a trajectory together (track/smoother.cc).
namespace smoothing {
inline constexpr int kSteps = 4;  // of a frame's descent, each time that a sweep comes by
// Sweeps end when a pair of them, forward and backward, lowers E by less than the first share of it
// [1], or after so many pairs. A frame is passed over if neither it nor a neighbour lowered E by
// more than the second share of a frame's part of E [1] when it was last visited.
inline constexpr double kConvergence = 1e-5, kStill = 1e-7;
inline constexpr int kPairs = 100;
}  // namespace smoothing

// When a search ends (search/stopping_rule.cc).
namespace stopping {
inline constexpr double kSameAnswer = 1.01;  // two answers are the same up to this ratio of their σ
// So many starts that were given up, since they promised nothing nearer, count as one that ended at
// the best answer. Chosen with the numbers of effort.h: bench/README.md, Agreement.
inline constexpr int kGivenUpPerAgreement = 6;
// Estimated time of a query, of a pair distance and of an LCP step per degree of freedom, the
// latter two over the distances at q_in but no fewer than kFewDistances [evaluations]: a regression
// over the solves of nine robots on one machine. It only bounds a search that found no agreement.
inline constexpr double kPerQuery = 0.3, kPerDistance = 0.8, kPerStepAndDof = 0.03;
inline constexpr int kFewDistances = 4;
}  // namespace stopping

// How a budget in seconds is shared out (problem/budget.h, bound/lower_bound_pair.h).
namespace budget {
inline constexpr double kLeastSearch = 0.5;  // searches keep this share, however long steps take
inline constexpr double kBound = 0.25;       // the lower bound takes at most this share
// The longest step and verification so far are remembered, and fade by this factor each time, so
// that one that was interrupted by the system is forgotten [1].
inline constexpr double kForgetting = 0.99;
}  // namespace budget

// What becomes of candidates that the verifier refuses (solve/acceptance.cc): they are moved on, by
// this share of their way from q_in, doubled up to the last one [1]; a candidate that is proven
// free but that MuJoCo's contacts dispute is moved no farther than kBeyondDisputed.
namespace acceptance {
inline constexpr double kFirstBeyond = 1e-4, kLastBeyond = 0.1, kBeyondDisputed = 0.01;
}  // namespace acceptance

// Continuous collision detection (ccd/ccdg.cc, ccd/pair_proof.cc).
namespace bisection {
inline constexpr double kNearestSplit = 0.25;  // no split is nearer to an end [interval]
// Where the proofs from both ends of an interval meet is known up to the curvature of the motion.
// It is split at this share of the way [1], if that is more than kWorthAsking times what the first
// proof covers [1]. On the motions that method paper makes on the sets of ablation_bench a share of
// 0.8 takes 9 % more poses, 1.0 takes 1 % more, and splitting only where proofs end (conservative
// advancement) a third more.
inline constexpr double kMeetShare = 0.97, kWorthAsking = 1.1;
// Motion bounds grow with the horizon: it is tried on the whole interval, then on this many times
// what that proved, at least kSmallestShrink of it [1]. The second horizon saves 1 % of the poses
// of usual motions, the third is for turns far away or along a long slide; a fourth would save less
// than a thousandth.
inline constexpr int kHorizons = 3;
inline constexpr double kHorizonPerReach = 4.0, kSmallestShrink = 1.0 / 16.0;
}  // namespace bisection

// The paper's method (paper/).
namespace paper {
inline constexpr int kIterations = 100;     // of contact-space projection
inline constexpr int kCorrections = 6;      // contacts at the minimizer that join those at q_c
inline constexpr int kReverseSamples = 16;  // of the motion that reverse projection goes back on
inline constexpr double kTouchingBand =
    10.0;                                // pairs this near at q_c are contacts [the CCD's gap]
inline constexpr int kTranslations = 4;  // trees carried off one after the other
inline constexpr int kKeyframes = 32;    // keyframes looked at
// Maximally clear configurations: this many clearances, each twice the one before, with this many
// random configurations for each.
inline constexpr int kClearLevels = 8, kClearSamples = 16;
}  // namespace paper

}  // namespace mjcf_pdg::tuning

#endif  // MJCF_PDG_SRC_BASE_TUNING_H_
