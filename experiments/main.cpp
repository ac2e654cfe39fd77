#include "experiments/command_line.h"

int main(int argc, char** argv) { return gib::run_program(argc, argv); }
