#pragma once
#include <vector>

#include "tests/bench/bench_main.h"
#include "tests/bench/methods.h"

namespace mortise::bench {

/// Every approach that the paper names beside ours: time, error, and what it cannot say.
void section_measures(Report& report, const BenchOptions& options);
void section_contact(Report& report, const BenchOptions& options);
void section_pairs(Report& report, const BenchOptions& options);

/// First contact by algebraic equations, by the swept volume, by adaptive bisection.
std::vector<Method> paper_methods(const MotionSet& set);

}  // namespace mortise::bench
