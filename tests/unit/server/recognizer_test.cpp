// Recognition in threads of its own, beside who asks for it.
#include "server/recognizer.h"

#include <gtest/gtest.h>

#include <chrono>
#include <map>
#include <thread>

#include "common/geometry/recognition/recognition.h"
#include "tests/support/shapes.h"

namespace mortise {
namespace {

using FeaturesOf = std::map<std::string, std::shared_ptr<const std::vector<Feature>>>;

SolidPtr bushing(double bore_mm) {
  return shapes::solid(shapes::ring({bore_mm, 0.0, 20.0, 64, 1, 0.0}, bore_mm + 5.0));
}

// Until it is done; each mesh once.
void take_all(Recognizer& recognizer, FeaturesOf& found) {
  for (bool done = false; !done;) {
    done = recognizer.done();  // what is taken below is then the last
    for (auto& [hash, features] : recognizer.take())
      EXPECT_TRUE(found.emplace(hash, std::move(features)).second);
    if (!done) std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
}

// As two uploads are that end at one time; one mesh is in both, and is asked by this thread too.
TEST(Recognizer, TwoAtATimeFindWhatOneFinds) {
  const SolidPtr shared = bushing(4.0);
  const std::vector<SolidPtr> meshes[] = {{bushing(3.0), shared}, {shared, bushing(6.0)}};
  Recognizer first(meshes[0]), second(meshes[1]);
  const std::size_t alone = recognize_features(*shared).features.size();
  FeaturesOf of_first, of_second;
  std::thread other([&] { take_all(second, of_second); });
  take_all(first, of_first);
  other.join();
  EXPECT_GE(alone, 2u);
  for (const auto& [all, found] : {std::pair{meshes[0], of_first}, std::pair{meshes[1], of_second}})
    for (const SolidPtr& mesh : all) {
      ASSERT_TRUE(found.contains(mesh->hash()));
      const std::vector<Feature> expected = recognize_features(*mesh).features;
      const std::vector<Feature>& features = *found.at(mesh->hash());
      ASSERT_EQ(features.size(), expected.size());
      for (std::size_t i = 0; i < features.size(); ++i)
        EXPECT_EQ(features[i].triangles, expected[i].triangles);
    }
}

TEST(Recognizer, IsNotWaitedForWhenItGoes) {
  for (int i = 0; i < 20; ++i) Recognizer gone({bushing(3.0), bushing(4.0)});
}

}  // namespace
}  // namespace mortise
