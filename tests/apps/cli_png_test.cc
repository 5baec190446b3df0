// Pictures: what overlaps is orange, what is free is blue, nothing hides either, and many rows fill
// several pages. Without EGL the program draws nothing, and these tests are skipped.
#include "tests/support/cli_test.h"

#ifdef MJCF_PDG_TESTS_HAVE_PNG
#include <png.h>

namespace mjcf_pdg::test {
namespace {

constexpr int kPictureWidth = 640;

struct Picture {
  int width = 0, height = 0;
  std::vector<std::uint8_t> rgb;

  using IsKind = bool (*)(const std::uint8_t*);
  // How many pixels of the left (0) or right (1) half are of a kind. The label is left out.
  int Count(int side, IsKind is_kind) const {
    int count = 0;
    for (int y = 40; y < height; ++y) {
      for (int x = side * width / 2; x < (side + 1) * width / 2; ++x) {
        count += is_kind(&rgb[3 * (static_cast<std::size_t>(y) * width + x)]);
      }
    }
    return count;
  }
};

bool IsOrange(const std::uint8_t* p) { return p[0] > 110 && p[0] > 2 * p[2] && p[1] < p[0]; }
bool IsBlue(const std::uint8_t* p) { return p[2] > 80 && p[2] > 2 * p[0]; }
bool IsBlack(const std::uint8_t* p) { return p[0] + p[1] + p[2] == 0; }

// A ball that has sunk into another, both inside a box that collides with nothing.
constexpr char kHidden[] = R"(<mujoco><worldbody><light pos="0 0 3"/>
  <geom name="post" type="sphere" size=".1" rgba="1 .5 0 1"/>
  <geom type="box" size=".5 .5 .5" contype="0" conaffinity="0" rgba="1 .5 0 1"/>
  <body name="ball" pos="0 0 .12"><joint type="slide" axis="0 0 1"/>
    <geom name="sphere" type="sphere" size=".08"/></body></worldbody></mujoco>)";

class CliPngTest : public CliTest {
 protected:
  void SetUp() override {
    CliTest::SetUp();
    if (IsSkipped()) return;
    if (Run({"solve", "--help"}).out.find("--png") == std::string::npos) {
      GTEST_SKIP() << "the program was built without EGL";
    }
  }

  Picture Load(const std::string& name) const {
    Picture picture;
    png_image png = {};
    png.version = PNG_IMAGE_VERSION;
    EXPECT_TRUE(png_image_begin_read_from_file(&png, (cwd() / name).c_str())) << png.message;
    png.format = PNG_FORMAT_RGB;
    picture.width = static_cast<int>(png.width);
    picture.height = static_cast<int>(png.height);
    picture.rgb.resize(PNG_IMAGE_SIZE(png));
    EXPECT_TRUE(png_image_finish_read(&png, nullptr, picture.rgb.data(), 0, nullptr));
    return picture;
  }
};

TEST_F(CliPngTest, OverlapsAreOrangeAndMarkedAndAnswersAreBlue) {
  EXPECT_EQ(Run({"solve", "scene.xml", "--key", "deep", "--png", "a.png"}).exit_code, 0);
  const Picture picture = Load("a.png");
  EXPECT_GT(picture.Count(0, IsOrange), 1000);
  EXPECT_EQ(picture.Count(0, IsBlue), 0);
  EXPECT_GT(picture.Count(0, IsBlack), 50);  // the ring around the contact
  EXPECT_GT(picture.Count(1, IsBlue), 1000);
  EXPECT_EQ(picture.Count(1, IsOrange), 0);
  EXPECT_EQ(picture.Count(1, IsBlack), 0);
}

TEST_F(CliPngTest, WhatOverlapsIsSeenThroughWhatCoversIt) {
  Write("hidden.xml", kHidden);
  EXPECT_EQ(Run({"solve", "hidden.xml", "--png", "a.png"}).exit_code, 0);
  const Picture picture = Load("a.png");
  EXPECT_GT(picture.Count(0, IsOrange), 1000);
  EXPECT_GT(picture.Count(1, IsBlue), 1000);
  EXPECT_EQ(picture.Count(1, IsOrange), 0);  // the orange box of the model has become grey
}

// Floors are tinted so that one sees what stands in them.
TEST_F(CliPngTest, AFloorIsTintedInStrongLightToo) {
  const std::string lamp = R"(<light dir="0 0 -1" directional="true" diffuse=".9 .9 .9"/>)";
  Write("bright.xml", R"(<mujoco><visual><headlight ambient=".4 .4 .4" diffuse=".6 .6 .6"/></visual>
    <worldbody>)" + lamp + lamp +
                          R"(<geom name="floor" type="plane" size="2 2 .1" rgba="1 1 1 1"/>
    <body name="ball" pos="0 0 .05"><joint type="slide" axis="0 0 1"/><geom size=".1"/></body>
    </worldbody></mujoco>)");
  EXPECT_EQ(Run({"solve", "bright.xml", "--png", "a.png"}).exit_code, 0);
  const Picture picture = Load("a.png");
  const auto is_warm = [](const std::uint8_t* p) { return p[0] > p[2] + 30; };
  const auto is_cool = [](const std::uint8_t* p) { return p[2] > p[0] + 30; };
  const int third = picture.width * picture.height / 6;  // of one of the two pictures
  EXPECT_GT(picture.Count(0, is_warm), third);
  EXPECT_GT(picture.Count(1, is_cool), third);
}

TEST_F(CliPngTest, WhatIsUnsolvedStaysOrange) {
  Write("stuck.xml", R"(<mujoco><worldbody><geom name="wall" type="box" size=".5 .5 .1"/>
    <body name="ball" pos="0 0 .15"><joint type="slide" axis="1 0 0" range="-.1 .1" limited="true"/>
      <geom name="sphere" size=".1"/></body></worldbody></mujoco>)");
  EXPECT_EQ(Run({"solve", "stuck.xml", "--png", "a.png"}).exit_code, 3);
  const Picture picture = Load("a.png");
  EXPECT_GT(picture.Count(1, IsOrange), 1000);
  EXPECT_GT(picture.Count(1, IsBlack), 50);
  EXPECT_EQ(picture.Count(1, IsBlue), 0);
}

TEST_F(CliPngTest, ManyRowsFillSeveralPages) {
  std::string rows;
  for (int i = 0; i < 26; ++i) rows += "0 " + std::to_string(0.002 * i) + "\n";
  Write("rows.txt", rows);
  const Outcome outcome =
      Run({"solve", "scene.xml", "--qpos-file", "rows.txt", "--png", "sheet.png"});
  EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
  EXPECT_EQ(Files().size(), 4u);  // the scene, the rows and two pages
  EXPECT_GT(Load("sheet.png").height, 3 * Load("sheet-2.png").height);
  EXPECT_GT(Load("sheet.png").width, 2 * 2 * kPictureWidth);
}

}  // namespace
}  // namespace mjcf_pdg::test

#endif
