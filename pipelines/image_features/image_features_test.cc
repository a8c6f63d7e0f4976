#include "pipelines/image_features/image_features.h"

#include <gtest/gtest.h>

#include <map>
#include <memory>

#include "pipelines/image_features/band_features.h"
#include "pipelines/testing/in_process.h"
#include "schema/rng.h"

namespace cairn::image_features {
namespace {

// Two runs of `samples` images of noise, 40 by 30 pixels, each with a range.
Blob Garden(int samples) {
  Blob blob;
  blob.Put("runs", Array::Texts({"out", "home"}));
  blob.Put("input_name", Array::Texts({"range"}));
  Rng rng(3);
  for (int run = 0; run < 2; ++run) {
    const std::string prefix = "run/" + std::to_string(run) + "/";
    std::vector<std::uint8_t> image;
    for (int i = 0; i < samples * 40 * 30 * 3; ++i)
      image.push_back(static_cast<std::uint8_t>(rng.Uniform(0, 256)));
    std::vector<float> range;
    for (int k = 0; k < samples; ++k) range.push_back(static_cast<float>(10 * run + k));
    blob.Put(prefix + "image", Array::Of({samples, 40, 30, 3}, image));
    blob.Put(prefix + "input", Array::Of({samples, 1}, range));
    blob.PutVector(prefix + "time_s", std::vector<double>(range.begin(), range.end()));
    for (const char* name : {"x_m", "y_m"}) blob.PutVector(prefix + name, std::vector<double>(range.size()));
  }
  return blob;
}

BlobPtr Extract(const Blob& samples, const Options& options = {}, int* tasks = nullptr) {
  return RunInProcess(ImageFeatures(options, 1), {{"samples", std::make_shared<const Blob>(samples)}},
                      [&](const proto::Step& step) {
                        if (tasks != nullptr) *tasks += step.tasks_size();
                      });
}

std::string Refusal(const Blob& samples, const Options& options = {}) {
  try {
    Extract(samples, options);
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

// As many images that a run takes more than one task.
TEST(ImageFeatures, PutsFeaturesBeforeTheInputsThatSamplesHad) {
  const int count = 2400;
  const Blob garden = Garden(count);
  int tasks = 0;
  const BlobPtr result = Extract(garden, {}, &tasks);
  EXPECT_EQ(tasks, 4);
  const std::vector<std::string> names = result->Texts("input_name");
  ASSERT_EQ(names.size(), 141U);
  EXPECT_EQ(names.front(), "row 0 brightness");
  EXPECT_EQ(names.back(), "range");
  EXPECT_EQ(result->Texts("runs"), garden.Texts("runs"));
  for (const int run : {0, 1}) {
    const std::string prefix = "run/" + std::to_string(run) + "/";
    ASSERT_EQ(result->at(prefix + "input").shape(), (Shape{count, 141}));
    EXPECT_EQ(result->at(prefix + "time_s"), garden.at(prefix + "time_s"));
    EXPECT_FALSE(result->Has(prefix + "image"));
    const auto rgb = garden.Get<std::uint8_t>(prefix + "image");
    for (const std::size_t k : {0, 1, 2398, 2399}) {
      std::vector<float> expected = BandFeatures({}, {40, 30, rgb.subspan(k * 3600, 3600)});
      expected.push_back(static_cast<float>(10 * run) + static_cast<float>(k));
      const auto row = result->Get<float>(prefix + "input").subspan(k * 141, 141);
      EXPECT_EQ(std::vector<float>(row.begin(), row.end()), expected) << "run " << run << ", image " << k;
    }
  }
}

// Nobody has more of the images than these.
TEST(ImageFeatures, ATaskReadsItsOwnImagesAndAllTasksReadAllOnce) {
  std::map<std::string, std::int64_t> next;
  RunInProcess(ImageFeatures({}, 1), {{"samples", std::make_shared<const Blob>(Garden(2400))}},
               [&](const proto::Step& step) {
                 EXPECT_TRUE(step.state().blobs().empty());
                 for (const Task& task : step.tasks()) {
                   ASSERT_EQ(task.inputs_size(), 1);
                   const proto::BlobPart& part = task.inputs(0).part();
                   ASSERT_EQ(part.fields_size(), 1);
                   EXPECT_EQ(part.first_row(), next[part.fields(0)]);
                   next[part.fields(0)] += part.row_count();
                 }
               });
  EXPECT_EQ(next, (std::map<std::string, std::int64_t>{{"run/0/image", 2400}, {"run/1/image", 2400}}));
}

TEST(ImageFeatures, OfSamplesWithoutOtherInputs) {
  Blob garden = Garden(3);
  garden.Put("input_name", Array::Texts({}));
  for (const char* run : {"run/0/input", "run/1/input"})
    garden.Put(run, Array::Of({3, 0}, std::vector<float>()));
  const BlobPtr result = Extract(garden, {.bands = 2});
  EXPECT_EQ(result->at("run/1/input").shape(), (Shape{3, 28}));
}

TEST(ImageFeatures, RefusesWhatIsNoImage) {
  Blob garden = Garden(2);
  EXPECT_EQ(Refusal(garden), "");
  EXPECT_EQ(
      Refusal(garden, {.bands = 31}),
      "run 'out': images of 40 by 30 pixels cannot be cut into 31 bands, nor can a smaller one for texture");
  garden.Put("run/1/image", Array::Of({3, 40, 30, 3}, std::vector<std::uint8_t>(3 * 3600)));
  EXPECT_NE(Refusal(garden).find("'run/1/image' has the shape [3,"), std::string::npos) << Refusal(garden);
  garden.Put("run/1/image", Array::Of({2, 40, 30, 4}, std::vector<std::uint8_t>(2 * 4800)));
  EXPECT_NE(Refusal(garden).find("'run/1/image' has the shape ["), std::string::npos) << Refusal(garden);
  EXPECT_EQ(Refusal(garden.Without("run/1/image")), "run 'home' has no images");
}

}  // namespace
}  // namespace cairn::image_features
