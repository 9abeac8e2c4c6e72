// Judges two files as they lie: ten_lines A.stl B.stl
#include <mortise/mortise.h>

#include <cstdio>

int main(int argc, char** argv) {
  using namespace mortise;
  const auto a = load(argc > 2 ? argv[1] : ""), b = load(argc > 2 ? argv[2] : "");
  if (!a || !b) return std::fprintf(stderr, "%s\n", (a ? b : a).error().text.c_str()), 3;
  const auto judgement = judge(*a, *b);
  if (!judgement) return 3;
  for (const Clash& clash : judgement->clashes) std::puts(clash.explanation.c_str());
  return judgement->worst() == CollisionClass::kReal ? 6 : 0;
}
