// solve --html: what is in the file. How it behaves in a browser: apps/html/web/check_report.mjs.
#include <zlib.h>

#include <cstdint>
#include <cstring>
#include <regex>

#include "tests/support/cli_test.h"

namespace mjcf_pdg::test {
namespace {

std::string FromBase64(const std::string& text) {
  const std::string digits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string bytes;
  std::uint32_t bits = 0;
  int count = 0;
  for (const char c : text) {
    if (c == '=') break;
    bits = bits << 6 | static_cast<std::uint32_t>(digits.find(c));
    count += 6;
    if (count >= 8) bytes += static_cast<char>(bits >> (count -= 8) & 255);
  }
  return bytes;
}

// The text of <script id="ID">.
std::string Script(const std::string& page, const std::string& id) {
  const std::string head = "id=\"" + id + "\">";
  const std::size_t begin = page.find(head);
  if (begin == std::string::npos) return "";
  const std::size_t end = page.find("</script>", begin);
  return page.substr(begin + head.size(), end - begin - head.size());
}

struct Block {
  nlohmann::json json;
  std::string bytes;
};

Block Unpack(const std::string& text) {
  const std::string packed = FromBase64(text);
  std::string bytes(std::size_t{1} << 22, '\0');
  uLongf size = bytes.size();
  EXPECT_EQ(uncompress(reinterpret_cast<Bytef*>(bytes.data()), &size,
                       reinterpret_cast<const Bytef*>(packed.data()), packed.size()),
            Z_OK);
  std::uint32_t length = 0;
  std::memcpy(&length, bytes.data(), 4);
  return {nlohmann::json::parse(bytes.substr(4, length)),
          bytes.substr(4 + length, size - 4 - length)};
}

TEST_F(CliTest, AReportHoldsSceneRowsAndSearch) {
  ASSERT_EQ(Run({"solve", "scene.xml", "--seed", "3", "--html", "r.html"}).exit_code, 0);
  const std::string page = Read("r.html");
  EXPECT_FALSE(std::regex_search(page.substr(0, 6000), std::regex("(src|href)=\"?http")));
  const nlohmann::json rows = nlohmann::json::parse(Script(page, "page"))["rows"];
  ASSERT_EQ(rows.size(), 2u);
  EXPECT_EQ(rows[0]["label"], "deep");
  EXPECT_EQ(rows[0]["status"], "solved");
  EXPECT_NEAR(rows[0]["depth"].get<double>(), 50.0, 1e-2);
  EXPECT_EQ(rows[1]["status"], "already_free");

  const Block scene = Unpack(Script(page, "scene"));
  ASSERT_EQ(scene.json["geoms"].size(), 2u);
  EXPECT_EQ(scene.json["geoms"][1]["type"], "sphere");

  const Block row = Unpack(Script(page, "row0"));
  EXPECT_EQ(row.json["contacts_in"].size(), 1u);
  EXPECT_EQ(row.json["joints"][0]["name"], "z");
  EXPECT_NEAR(row.json["joints"][0]["moved"].get<double>(), 50.0, 1e-2);
  EXPECT_GE(row.json["iterations"].size(), 2u);
  EXPECT_EQ(row.json["command"], "mjcf-pdg solve scene.xml --seed 3 --qpos '0.0 0.0'");
  // Poses of the world and the ball in each frame: z of the ball, as given and in the answer.
  const std::size_t frames = row.json["frames"].size(), pose = 7 * sizeof(float);
  ASSERT_GE(frames, 3u);
  ASSERT_EQ(row.bytes.size(), frames * 2 * pose);
  float first = 0.0f, last = 0.0f;
  std::memcpy(&first, row.bytes.data() + pose + 2 * sizeof(float), sizeof first);
  std::memcpy(&last, row.bytes.data() + row.bytes.size() - pose + 2 * sizeof(float), sizeof last);
  EXPECT_FLOAT_EQ(first, 0.15f);
  EXPECT_NEAR(last, 0.2f, 1e-5f);
}

// The command that a report shows makes the row again.
TEST_F(CliTest, AReportsCommandMakesTheRowAgain) {
  const std::string model = MJCF_PDG_MODEL_DIR "/puma/puma_car.xml";
  ASSERT_EQ(Run({"solve", model, "--key", "arm_through_door", "--html", "r.html"}).exit_code, 0);
  const std::string page = Read("r.html");
  const Block row = Unpack(Script(page, "row0"));
  const std::string command = row.json["command"];
  const std::size_t quote = command.find('\'');
  const std::string qpos = command.substr(quote + 1, command.size() - quote - 2);
  const nlohmann::json again = SolveJson({model, "--qpos", qpos}).at(0);
  EXPECT_EQ(row.json["facts"][2][1], again["sigma"]);
  EXPECT_GT(Unpack(Script(page, "scene")).json["meshes"].size(), 0u);
}

TEST_F(CliTest, NamesCannotLeaveTheirPlaceInAReport) {
  Write("evil.xml", std::regex_replace(std::string(kBallAndWall), std::regex("\"deep\""),
                                       "\"&lt;/script&gt;&lt;b&gt;\""));
  ASSERT_EQ(Run({"solve", "evil.xml", "--html", "r.html"}).exit_code, 0);
  EXPECT_EQ(nlohmann::json::parse(Script(Read("r.html"), "page"))["rows"][0]["label"],
            "</script><b>");
}

TEST_F(CliTest, AReportIsForOneModelAndWrittenWholeOrNotAtAll) {
  ExpectRefused({"solve", "scene.xml", "scene.xml", "--html", "r.html"},
                "--html is for a single model");
  ExpectRefused({"solve", "scene.xml", "--html", "scene.xml"}, "--html");
  ExpectRefused({"solve", "scene.xml", "--key", "none", "--html", "r.html"}, "none");
}

}  // namespace
}  // namespace mjcf_pdg::test
