#include "pipelines/common/layered_grid.h"

#include <gtest/gtest.h>

#include <cmath>

#include "schema/rng.h"

namespace cairn {
namespace {

Layer RandomLayer(const Box& box, std::uint64_t seed) {
  Rng rng(seed);
  Layer layer(box);
  for (double& value : layer.values) value = rng.Uniform();
  return layer;
}

TEST(Box, UnionAndIntersectionKeepToTheirNames) {
  const Box a{0, 0, 4, 3}, b{2, -1, 5, 2};
  EXPECT_EQ(Union(a, b), (Box{0, -1, 7, 4}));
  EXPECT_EQ(Intersection(a, b), (Box{2, 0, 2, 1}));
  EXPECT_TRUE(Intersection(a, Box{10, 10, 1, 1}).empty());
  EXPECT_EQ(Union(Box{}, b), b);
}

TEST(Layer, CoverKeepsValuesAndPruneTightensTheBox) {
  Layer layer(Box{2, 3, 2, 1});
  layer.Row(3)[2] = 0.5;
  layer.Row(3)[3] = 0.001;
  layer.Cover(Box{-1, 0, 1, 1});
  EXPECT_EQ(layer.box, (Box{-1, 0, 5, 4}));
  EXPECT_EQ(layer.At(2, 3), 0.5);
  layer.Prune(0.01);
  EXPECT_EQ(layer.box, (Box{2, 3, 1, 1}));
  EXPECT_EQ(layer.Sum(), 0.5);
  layer.Prune(1.0);
  EXPECT_TRUE(layer.box.empty());
}

TEST(LayeredGrid, SparseStorageKeepsAllAndNoZero) {
  LayeredGrid grid;
  grid.layers = {Layer(Box{-3, 2, 5, 2}), Layer(), Layer(Box{7, -1, 1, 1}), Layer(Box{0, 0, 3, 1})};
  grid.layers[0].values = {0.0, 1.5, 2.5, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 3.5};
  grid.layers[2].values = {4.5};  // its run must not be joined with the one before
  Blob blob;
  grid.StoreSparse("alpha/", &blob);
  EXPECT_EQ(blob.at("alpha/value").size(), 4);
  EXPECT_EQ(blob.at("alpha/run").shape(), (std::vector<std::int64_t>{3, 2}));
  const LayeredGrid again = LayeredGrid::LoadSparse("alpha/", blob);
  ASSERT_EQ(again.layers.size(), grid.layers.size());
  for (std::size_t i = 0; i < grid.layers.size(); ++i) {
    EXPECT_EQ(again.layers[i].box, grid.layers[i].box);
    EXPECT_EQ(again.layers[i].values, grid.layers[i].values);
  }
}

TEST(LayeredGrid, SparseStorageThatDoesNotAddUpIsRefused) {
  LayeredGrid grid;
  grid.layers = {Layer(Box{0, 0, 4, 1}), Layer(Box{0, 0, 2, 1})};
  grid.layers[0].values = {0.0, 1.0, 1.0, 0.0};
  grid.layers[1].values = {0.0, 1.0};
  Blob good;
  grid.StoreSparse("", &good);
  const auto runs = [&](const std::vector<std::int64_t>& values) {
    Blob bad = good;
    bad.Put("run", Array::Of<std::int64_t>({static_cast<std::int64_t>(values.size() / 2), 2}, values));
    return bad;
  };
  EXPECT_NO_THROW(LayeredGrid::LoadSparse("", runs({1, 2, 5, 1})));
  for (const std::vector<std::int64_t>& values :
       std::vector<std::vector<std::int64_t>>{{1, 2},
                                              {1, 2, 6, 1},
                                              {1, 2, 5, 2},
                                              {3, 2, 5, 1},
                                              {1, 2, 2, 1},
                                              {5, 1, 1, 2},
                                              {1, 4},
                                              {1, 3, 5, 0},
                                              {-1, 2, 5, 1},
                                              {1, 1, 2, 1, 5, 1, 5, 1}}) {
    EXPECT_THROW(LayeredGrid::LoadSparse("", runs(values)), InputError);
  }
  Blob bad = good;
  bad.Put("box", Array::Of<std::int32_t>({2, 4}, std::vector<std::int32_t>{0, 0, 1 << 30, 1, 0, 0, 2, 1}));
  EXPECT_THROW(LayeredGrid::LoadSparse("", bad), InputError);
}

// A few bytes may stand for very many zeros.
TEST(LayeredGrid, SparseStorageOfMoreCellsThanOneAllowsIsRefused) {
  Blob few;
  few.Put("box",
          Array::Of<std::int32_t>({2, 4}, std::vector<std::int32_t>{0, 0, 1 << 24, 1 << 24, 0, 0, 2, 1}));
  few.Put("run", Array::Of<std::int64_t>({0, 2}, std::vector<std::int64_t>{}));
  few.PutVector<double>("value", {});
  EXPECT_THROW(LayeredGrid::LoadSparse("", few, 1e9), InputError);
  few.Put("box", Array::Of<std::int32_t>({1, 4}, std::vector<std::int32_t>{0, 0, 10, 10}));
  EXPECT_THROW(LayeredGrid::LoadSparse("", few, 99.0), InputError);
  EXPECT_EQ(LayeredGrid::LoadSparse("", few, 100.0).cells(), 100);
}

TEST(LayeredGrid, StoresAndLoadsTheSame) {
  LayeredGrid grid;
  grid.layers = {RandomLayer({-3, 2, 4, 5}, 1), Layer(), RandomLayer({7, 7, 1, 1}, 2)};
  Blob blob;
  grid.Store("alpha/", &blob);
  const LayeredGrid again = LayeredGrid::Load("alpha/", blob);
  ASSERT_EQ(again.layers.size(), 3U);
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_EQ(again.layers[i].box, grid.layers[i].box);
    EXPECT_EQ(again.layers[i].values, grid.layers[i].values);
  }
}

TEST(LayeredGrid, RefusesBoxesThatDoNotFitTheValues) {
  Blob blob;
  blob.Put("box", Array::Of<std::int32_t>({1, 4}, std::vector<std::int32_t>{0, 0, 2, 2}));
  blob.PutVector<double>("value", {1, 2, 3});
  EXPECT_THROW(LayeredGrid::Load("", blob), InputError);
  blob.PutVector<double>("value", {1, 2, 3, 4, 5});
  EXPECT_THROW(LayeredGrid::Load("", blob), InputError);
  blob.Put("box", Array::Of<std::int32_t>({1, 4}, std::vector<std::int32_t>{0, 0, 1 << 30, 1 << 30}));
  EXPECT_THROW(LayeredGrid::Load("", blob), InputError);
}

TEST(Sum, AgreesWithALongDoubleOne) {
  const Layer layer = RandomLayer({0, 0, 37, 11}, 3);
  long double exact = 0;
  for (const double value : layer.values) exact += value;
  EXPECT_NEAR(layer.Sum(), static_cast<double>(exact), 1e-10);
}

TEST(Blur, KeepsMassAndAddsVariance) {
  Layer point(Box{5, -4, 1, 1});
  point.values[0] = 2.0;
  for (const double sigma : {0.3, 0.6, 1.0, 2.5}) {
    const Layer blurred = Blur(point, sigma);
    double mass = 0, xx = 0, yy = 0;
    for (int y = blurred.box.y0; y < blurred.box.y0 + blurred.box.ny; ++y) {
      for (int x = blurred.box.x0; x < blurred.box.x0 + blurred.box.nx; ++x) {
        const double m = blurred.Row(y)[x];
        mass += m;
        xx += m * (x - 5) * (x - 5);
        yy += m * (y + 4) * (y + 4);
      }
    }
    EXPECT_NEAR(mass, 2.0, 1e-12);
    EXPECT_NEAR(xx / mass, sigma * sigma, 0.02 * sigma * sigma);
    EXPECT_NEAR(yy / mass, sigma * sigma, 0.02 * sigma * sigma);
  }
}

TEST(DiscSum, EqualsTheSumOverCellsWithinTheRadius) {
  const Layer layer = RandomLayer({-4, 1, 9, 7}, 5);
  const double radius = 3.3;
  const Layer sums = DiscSum(layer, radius);
  for (int y = sums.box.y0; y < sums.box.y0 + sums.box.ny; ++y) {
    for (int x = sums.box.x0; x < sums.box.x0 + sums.box.nx; ++x) {
      double expected = 0;
      for (int j = -4; j <= 4; ++j) {
        for (int i = -4; i <= 4; ++i) {
          if (i * i + j * j <= radius * radius) expected += layer.At(x + i, y + j);
        }
      }
      ASSERT_NEAR(sums.Row(y)[x], expected, 1e-12) << x << ' ' << y;
    }
  }
}

}  // namespace
}  // namespace cairn
