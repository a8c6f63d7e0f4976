#include "datasets/import_images.h"

#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>

#include "datasets/images/decode_image.h"
#include "datasets/testing.h"

namespace cairn::datasets {
namespace {

std::vector<ImageReading> ReadHere(const std::vector<std::string>& paths) {
  std::vector<ImageReading> readings;
  for (const std::string& path : paths) {
    ImageReading& reading = readings.emplace_back();
    try {
      reading.features = ImageFeatures(DecodeImage(path));
    } catch (const InputError& error) {
      reading.failure = error.what();
    }
  }
  return readings;
}

class ImportImagesTest : public ImportTest {
 protected:
  ImagesImportOptions options_;
  const std::string header_ = "image,time_s,x_m,y_m\n";

  void SetUp() override {
    options_.folder = folder_ / "garden";
    std::filesystem::create_directories(options_.folder + "/deep");
    for (const char* name : {"a.png", "b.jpg", "deep/c.ppm"}) PutImage(name, 12, 16);
  }
  void PutImage(const std::string& name, int rows, int columns) {
    cv::Mat image(rows, columns, CV_8UC3);
    cv::randu(image, 0, 256);
    ASSERT_TRUE(cv::imwrite(options_.folder + "/" + name, image));
  }
  ImportReport Import(const std::string& table) {
    options_.poses = folder_.Put("poses.csv", table);
    return ImportImages(options_, ReadHere, &log_);
  }
  std::string Failure(const std::string& table) {
    log_ = Blob();
    const std::string failure = InputErrorOf([&] { Import(table); });
    EXPECT_TRUE(failure.empty() || log_.fields().empty()) << "refused, and yet something was made";
    return failure;
  }
};

TEST_F(ImportImagesTest, PutsFeaturesBeforeTheTablesInputs) {
  Import(
      "sonar,x_m,y_m,time_s,image,heading_rad\n5,1,2,3,a.png,0.5\n6,7,8,9,./deep/"
      "c.ppm,0\n7,1,1,10,b.jpg,0\n");
  EXPECT_EQ(log_.Texts("runs"), (std::vector<std::string>{"garden"}));
  const std::vector<std::string> names = log_.Texts("input_name");
  ASSERT_EQ(names.size(), 141U);
  EXPECT_EQ(names.front(), "row 0 brightness");
  EXPECT_EQ(names.back(), "sonar");
  EXPECT_EQ(Column<double>("run/0/x_m"), (std::vector<double>{1, 7, 1}));
  EXPECT_EQ(Column<double>("run/0/heading_rad"), (std::vector<double>{0.5, 0, 0}));
  EXPECT_EQ(log_.at("run/0/input").shape(), (Shape{3, 141}));
  std::vector<float> second = ImageFeatures(DecodeImage(options_.folder + "/deep/c.ppm"));
  second.push_back(6);
  const std::vector<float> input = Column<float>("run/0/input");
  EXPECT_EQ(std::vector<float>(input.begin() + 141, input.begin() + 282), second);
}

TEST_F(ImportImagesTest, RunsAreByTheirColumn) {
  Import(
      "image,time_s,x_m,y_m,run\na.png,5,0,0,out\nb.jpg,1,0,0,home\ndeep/"
      "c.ppm,6,1,0,out\na.png,2,3,0,home\n");
  EXPECT_EQ(log_.Texts("runs"), (std::vector<std::string>{"out", "home"}));
  EXPECT_EQ(Column<double>("run/0/time_s"), (std::vector<double>{5, 6}));
  EXPECT_EQ(Column<double>("run/1/time_s"), (std::vector<double>{1, 2}));
  EXPECT_EQ(log_.Texts("input_name").size(), 140U);
}

TEST_F(ImportImagesTest, BadTablesNameFileLineAndReason) {
  const std::string all = "a.png,1,0,0\nb.jpg,2,1,0\ndeep/c.ppm,3,2,0\n";
  EXPECT_EQ(Failure(header_ + all), "");
  ExpectContains(Failure(header_ + all + "d.png,4,0,0\n"), "poses.csv:5: no such image: ");
  ExpectContains(Failure(header_ + all + "a.png,1,0,0\n"), "poses.csv:5: time runs backwards");
  ExpectContains(Failure(header_ + all + "a.png,5,east,0\n"), "poses.csv:5: not a number");
  ExpectContains(Failure("image,time_s,x_m,y_m,run\na.png,1,0,0,\n"), "poses.csv:2: run without a name");
  ExpectContains(Failure("image,time_s,x_m\n"), "poses.csv:1: the header lacks columns");
  ExpectContains(Failure("image,time_s,x_m,y_m,row 0 red\n"), "'row 0 red' is called as an image's feature");
  ExpectContains(Failure(header_ + "a.png,1,0,0\nb.jpg,2,0,0\n"), "deep/c.ppm: image without a pose: ");
  ExpectContains(Failure("image,time_s,x_m,y_m,run\n"
                         "a.png,1,0,0,r\nb.jpg,2,0,0,r\ndeep/c.ppm,2,0,0,s\n"),
                 "poses.csv: a run has two samples or more; 's' has one");
  options_.folder = folder_ / "nowhere";
  ExpectContains(Failure(header_ + all), "nowhere: there is no such folder");
}

TEST_F(ImportImagesTest, BadImagesNameTheLine) {
  folder_.Put("garden/text.png", "no image");
  PutImage("small.png", 9, 30);
  const std::string all = "a.png,1,0,0\nb.jpg,2,1,0\ndeep/c.ppm,3,2,0\n";
  ExpectContains(Failure(header_ + all + "text.png,4,3,0\nsmall.png,5,4,0\n"),
                 "poses.csv:5: bad image: " + options_.folder + "/text.png: it cannot be decoded");
  ExpectContains(Failure(header_ + all + "small.png,4,3,0\ntext.png,5,4,0\n"),
                 "small.png: it has 9 by 30 pixels; 10 by 10 or more are needed");
  options_.skip_bad = true;
  const ImportReport report =
      Import(header_ + "a.png,1,0,0\nb.jpg,2,1,0\nsmall.png,4,3,0\ntext.png,5,4,0\nx.png,6,0,0\n");
  EXPECT_EQ(report.skipped, (std::map<std::string, std::int64_t>{
                                {"bad image", 2}, {"image without a pose", 1}, {"no such image", 1}}));
  EXPECT_EQ(Column<double>("run/0/time_s"), (std::vector<double>{1, 2}));
}

TEST(DecodeImage, KeepsColoursInOrder) {
  const TestFolder folder;
  const cv::Mat image(10, 11, CV_8UC3, cv::Scalar(30, 20, 10));  // blue, green, red
  ASSERT_TRUE(cv::imwrite(folder / "a.png", image));
  const RgbImage rgb = DecodeImage(folder / "a.png");
  EXPECT_EQ(rgb.rows, 10);
  EXPECT_EQ(rgb.columns, 11);
  ASSERT_EQ(rgb.rgb.size(), 330U);
  EXPECT_EQ((std::vector<std::uint8_t>{rgb.rgb[327], rgb.rgb[328], rgb.rgb[329]}),
            (std::vector<std::uint8_t>{10, 20, 30}));
}

}  // namespace
}  // namespace cairn::datasets
