#ifndef MJCF_PDG_TESTS_CONSUMER_FOLLOW_H_
#define MJCF_PDG_TESTS_CONSUMER_FOLLOW_H_

struct mjModel_;

// A model of one slide, as in main.cc.
bool FollowsCommandsWithoutTouching(const mjModel_* model);

#endif  // MJCF_PDG_TESTS_CONSUMER_FOLLOW_H_
