#include "client/replay/options.h"

int main(int argc, char** argv) { return mortise::run_replay_program(argc, argv); }
