// Pictures: what overlaps is orange, what is free is blue, nothing hides either, and many rows fill
// several pages. Without EGL the program draws nothing, and these tests are skipped.
#include "tests/support/cli_test.h"

#ifdef MJCF_PDG_TESTS_HAVE_PNG
#include <gif_lib.h>
#include <gmock/gmock.h>
#include <png.h>

#include <filesystem>

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

// The frames of a GIF, read by its library, as they are shown one after the other.
struct Gif {
  struct Frame {
    Picture picture;
    int hundredths = 0;
  };
  std::vector<Frame> frames;
};

Gif LoadGif(const std::string& path) {
  Gif gif;
  int error = 0;
  GifFileType* const file = DGifOpenFileName(path.c_str(), &error);
  if (!file) return gif;
  EXPECT_EQ(DGifSlurp(file), GIF_OK);
  Picture shown;
  shown.width = file->SWidth;
  shown.height = file->SHeight;
  shown.rgb.resize(std::size_t{3} * static_cast<std::size_t>(shown.width * shown.height));
  for (int i = 0; i < file->ImageCount; ++i) {
    GraphicsControlBlock control = {};
    EXPECT_EQ(DGifSavedExtensionToGCB(file, i, &control), GIF_OK);
    for (std::size_t pixel = 0; pixel < shown.rgb.size() / 3; ++pixel) {
      const int index = file->SavedImages[i].RasterBits[pixel];
      if (index == control.TransparentColor) continue;
      const GifColorType& color = file->SColorMap->Colors[index];
      shown.rgb[3 * pixel] = color.Red;
      shown.rgb[3 * pixel + 1] = color.Green;
      shown.rgb[3 * pixel + 2] = color.Blue;
    }
    gif.frames.push_back({shown, control.DelayTime});
  }
  DGifCloseFile(file, nullptr);
  return gif;
}

// Both halves of a picture together.
int CountAll(const Picture& picture, Picture::IsKind is_kind) {
  return picture.Count(0, is_kind) + picture.Count(1, is_kind);
}

TEST_F(CliPngTest, AnAnimationGoesFromTheOverlapToTheAnswer) {
  const Outcome outcome =
      Run({"solve", "scene.xml", "--key", "deep", "--animation", "a.gif", "--png", "a.png"});
  EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
  // As readable for others as any output.
  EXPECT_EQ(std::filesystem::status(cwd() / "a.gif").permissions(),
            std::filesystem::status(cwd() / "a.png").permissions());
  const Gif gif = LoadGif((cwd() / "a.gif").string());
  ASSERT_GT(gif.frames.size(), 10u);
  const Picture &first = gif.frames.front().picture, &last = gif.frames.back().picture;
  EXPECT_EQ(first.width, kPictureWidth);
  EXPECT_GT(CountAll(first, IsOrange), 1000);
  EXPECT_EQ(CountAll(first, IsBlue), 0);
  EXPECT_EQ(CountAll(last, IsOrange), 0);
  const int blue = Load("a.png").Count(1, IsBlue);
  EXPECT_NEAR(CountAll(last, IsBlue), blue, 0.01 * blue);  // of 255 colours
  EXPECT_EQ(gif.frames.back().hundredths, 100);
  // What stands still takes no room.
  EXPECT_LT(std::filesystem::file_size(cwd() / "a.gif"), gif.frames.size() * first.rgb.size() / 30);
}

TEST_F(CliPngTest, ATrajectoryIsShownBesideItsAnswers) {
  Write("rows.txt", "0 .05\n0 0\n0 -.05\n");
  const Outcome outcome = Run(
      {"solve", "scene.xml", "--qpos-file", "rows.txt", "--trajectory", "--animation", "a.gif"});
  EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
  const Gif gif = LoadGif((cwd() / "a.gif").string());
  ASSERT_EQ(gif.frames.size(), 3u);
  for (const Gif::Frame& frame : gif.frames) {
    EXPECT_GT(frame.picture.Count(0, IsOrange) + frame.picture.Count(0, IsBlue), 200);
    EXPECT_GT(frame.picture.Count(1, IsBlue), 200);
    EXPECT_EQ(frame.picture.Count(1, IsOrange), 0);
  }
}

TEST_F(CliPngTest, AnAnimationOfAPathEndsAtItsGoal) {
  if (Run({"plan", "--help"}).exit_code != 0) GTEST_SKIP() << "the program was built without OMPL";
  const Outcome outcome =
      Run({"plan", "scene.xml", "--start", "deep", "--goal", "0 .5", "--animation", "a.gif"});
  EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
  const Gif gif = LoadGif((cwd() / "a.gif").string());
  ASSERT_EQ(gif.frames.size(), 121u);
  for (const std::size_t frame : {0u, 60u, 120u}) {
    EXPECT_GT(CountAll(gif.frames[frame].picture, IsBlue), 200) << frame;
    EXPECT_EQ(CountAll(gif.frames[frame].picture, IsOrange), 0) << frame;
  }
  EXPECT_NE(gif.frames.front().picture.rgb, gif.frames.back().picture.rgb);
}

// Mocap bodies stand where the keyframe has them.
TEST_F(CliPngTest, MocapBodiesAreDrawnWhereTheyAre) {
  Write("mocap.xml", R"(<mujoco><worldbody>
    <body name="hand" mocap="true" pos="0 0 9"><geom type="box" size=".5 .5 .1"/></body>
    <body name="ball"><joint type="slide" axis="0 0 1"/><geom size=".1"/></body></worldbody>
    <keyframe><key name="pressed" qpos="0" mpos="0 0 -.12"/></keyframe></mujoco>)");
  EXPECT_EQ(Run({"solve", "mocap.xml", "--key", "pressed", "--png", "a.png"}).exit_code, 0);
  // The plate, too, is guilty and near.
  EXPECT_GT(Load("a.png").Count(1, IsBlue), 10000);
}

TEST_F(CliPngTest, AnAnimationIsRefusedBeforeAnyWork) {
  for (const char* name : {"a.png", "-", "missing/a.gif"}) {
    const Outcome outcome = Run({"solve", "scene.xml", "--animation", name});
    EXPECT_EQ(outcome.exit_code, 2) << name;
    EXPECT_THAT(outcome.err, testing::HasSubstr("--animation")) << name;
  }
  EXPECT_EQ(Files().size(), 1u);
}

}  // namespace
}  // namespace mjcf_pdg::test

#endif
