#define POLYGLIDE_INSTANCE template
#include "eigen_instances.hpp"
