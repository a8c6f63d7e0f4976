// Short runs of the fuzz targets, the same everywhere. Long ones: README.md.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <map>
#include <string>

#include "schema/store/encode.h"
#include "schema/wire/codec.h"
#include "tests/fuzz/mutate.h"
#include "tests/fuzz/targets.h"

namespace cairn::fuzz {
namespace {

using Target = Outcome (*)(std::span<const std::uint8_t>);

// Runs `target` on `count` mutations of the seeds and counts the outcomes.
std::map<Outcome, int> Outcomes(Target target, const std::vector<Bytes>& seeds, int count) {
  std::map<Outcome, int> outcomes;
  for (int i = 0; i < count; ++i) {
    Rng rng(1998, static_cast<std::uint64_t>(i));
    const Bytes bytes = Mutate(seeds[rng.Below(seeds.size())], &rng);
    ++outcomes[target(bytes)];
  }
  return outcomes;
}

TEST(Fuzz, NoCsvCrashesTheImportOrGivesAnImpossibleLog) {
  std::vector<Bytes> seeds;
  constexpr std::array<std::string_view, 6> kFiles{
      "time_s,robot,turn_rad,forward_m\n1,a,0,1\n2,a,0.5,1\n2,b,0,1\n3,a,0,0\n",
      "time_s,robot,landmark,range_m,bearing_rad\n1,a,door,2,0.1\n2,a,,,\n2,b,\"arch\",1,0\n",
      "time_s,robot,x_m,y_m,heading_rad\n1,a,0,0,0\n2,a,1,1,-4\n2,b,1,1,1\n",
      "landmark,x_m,y_m\ndoor,1,2\narch,3,4\n",
      "time_s,robot,landmark\n1,a,door\n2,a,arch\n2,b,\n",
      "time_s,robot,v_mps,omega_radps\n1,a,1,0.5\n2,a,0.5,1\n2,b,0,1\n5,b,2,2\n",
  };
  for (std::size_t i = 0; i < kFiles.size(); ++i) {
    for (const int skip_bad : {0, 130}) {
      Bytes seed(kFiles[i].begin(), kFiles[i].end());
      seed.insert(seed.begin(), static_cast<std::uint8_t>(i % 5 + static_cast<std::size_t>(skip_bad)));
      ASSERT_EQ(FuzzCsv(seed), Outcome::kAccepted) << kFiles[i];
      seeds.push_back(seed);
    }
  }
  const auto outcomes = Outcomes(FuzzCsv, seeds, 4000);
  EXPECT_GT(outcomes.at(Outcome::kAccepted), 200);
  EXPECT_GT(outcomes.at(Outcome::kRefused), 200);
}

Bytes FileOf(const Blob& blob) {
  const store::Image image = store::EncodeBlob("log", blob).value();
  const auto* data = reinterpret_cast<const std::uint8_t*>(image.data.get());
  return {data, data + image.size};
}

TEST(Fuzz, NoBytesCrashTheFileReaderOrGiveABlobThatDoesNotComeBack) {
  Blob small, large;
  small.PutScalar<double>("x_m", 1);
  for (int i = 0; i < 20; ++i) {
    const std::string robot = "robot/" + std::to_string(i) + "/";
    large.PutVector<double>(robot + "time_s", std::vector<double>(static_cast<std::size_t>(i), 0.1));
    large.Put(robot + "name", Array::Texts({"a", "Grüße"}));
    large.Put(robot + "grid", Array::Of<float>({2, 3}, std::vector<float>(6, 0.5F)));
  }
  large.PutVector<std::uint8_t>("zeros", std::vector<std::uint8_t>(70000));
  const std::vector<Bytes> seeds{FileOf(small), FileOf(large)};
  for (const Bytes& seed : seeds) ASSERT_EQ(FuzzBlobFile(seed), Outcome::kAccepted);
  const auto outcomes = Outcomes(FuzzBlobFile, seeds, 2000);
  EXPECT_GT(outcomes.at(Outcome::kRefused), 500);
}

void AddFrame(std::span<const std::byte> frame, Bytes& bytes) {
  bytes.push_back(static_cast<std::uint8_t>(frame.size()));
  bytes.push_back(static_cast<std::uint8_t>(frame.size() >> 8));
  for (const std::byte b : frame) bytes.push_back(std::to_integer<std::uint8_t>(b));
}

Bytes BytesOf(const wire::Message& message) {
  const wire::Frames frames = wire::Encode(message);
  Bytes bytes;
  AddFrame(std::as_bytes(std::span(frames.envelope)), bytes);
  for (const Array& array : frames.arrays) AddFrame(array.bytes(), bytes);
  return bytes;
}

TEST(Fuzz, NoMessageCrashesTheDecoderOrGivesABlobOfAnotherHash) {
  Blob blob;
  blob.PutVector<double>("x_m", {1, 2, 3});
  blob.Put("empty", Array::Of<float>({2, 0}, std::vector<float>()));
  blob.Put("names", Array::Texts({"a", "Grüße"}));
  wire::Message data, done, assign;
  data.envelope.mutable_blob();
  data.blobs = {wire::NameBlob(std::make_shared<const Blob>(blob))};
  done.envelope.mutable_done()->mutable_key()->set_job("museum");
  done.blobs = {data.blobs[0], data.blobs[0]};
  wire::Assign& task = *assign.envelope.mutable_assign();
  task.mutable_stage()->set_pipeline("landmark_map");
  (*task.mutable_inputs())["log"] = data.blobs[0].hash.Binary();
  task.add_partials("short");
  const std::vector<Bytes> seeds{BytesOf(data), BytesOf(done), BytesOf(assign)};
  for (const Bytes& seed : seeds) ASSERT_EQ(FuzzMessage(seed), Outcome::kAccepted);
  const auto outcomes = Outcomes(FuzzMessage, seeds, 20000);
  EXPECT_GT(outcomes.at(Outcome::kAccepted), 500);
  EXPECT_GT(outcomes.at(Outcome::kRefused), 5000);
}

}  // namespace
}  // namespace cairn::fuzz
