// Transcribed figures; every entry names its source. Values are in the order of increasing wavelength.
#include "spectrum/data/tables.h"

// clang-format off
namespace abbe::data {
namespace {

constexpr double kcornell_white[] = {
    0.343, 0.445, 0.551, 0.624, 0.665, 0.687, 0.708, 0.723, 0.715, 0.71, 0.745, 0.758, 0.739, 0.767, 0.777, 0.765,
    0.751, 0.745, 0.748, 0.729, 0.745, 0.757, 0.753, 0.75, 0.746, 0.747, 0.735, 0.732, 0.739, 0.734, 0.725, 0.721,
    0.733, 0.725, 0.732, 0.743, 0.744, 0.748, 0.728, 0.716, 0.733, 0.726, 0.713, 0.74, 0.754, 0.764, 0.752, 0.736,
    0.734, 0.741, 0.74, 0.732, 0.745, 0.755, 0.751, 0.744, 0.731, 0.733, 0.744, 0.731, 0.712, 0.708, 0.729, 0.73,
    0.727, 0.707, 0.703, 0.729, 0.75, 0.76, 0.751, 0.739, 0.724, 0.73, 0.74, 0.737,
};
constexpr double kcornell_red[] = {
    0.04, 0.046, 0.048, 0.053, 0.049, 0.05, 0.053, 0.055, 0.057, 0.056, 0.059, 0.057, 0.061, 0.061, 0.06, 0.062,
    0.062, 0.062, 0.061, 0.062, 0.06, 0.059, 0.057, 0.058, 0.058, 0.058, 0.056, 0.055, 0.056, 0.059, 0.057, 0.055,
    0.059, 0.059, 0.058, 0.059, 0.061, 0.061, 0.063, 0.063, 0.067, 0.068, 0.072, 0.08, 0.09, 0.099, 0.124, 0.154,
    0.192, 0.255, 0.287, 0.349, 0.402, 0.443, 0.487, 0.513, 0.558, 0.584, 0.62, 0.606, 0.609, 0.651, 0.612, 0.61,
    0.65, 0.638, 0.627, 0.62, 0.63, 0.628, 0.642, 0.639, 0.657, 0.639, 0.635, 0.642,
};
constexpr double kcornell_green[] = {
    0.092, 0.096, 0.098, 0.097, 0.098, 0.095, 0.095, 0.097, 0.095, 0.094, 0.097, 0.098, 0.096, 0.101, 0.103, 0.104,
    0.107, 0.109, 0.112, 0.115, 0.125, 0.14, 0.16, 0.187, 0.229, 0.285, 0.343, 0.39, 0.435, 0.464, 0.472, 0.476,
    0.481, 0.462, 0.447, 0.441, 0.426, 0.406, 0.373, 0.347, 0.337, 0.314, 0.285, 0.277, 0.266, 0.25, 0.23, 0.207,
    0.186, 0.171, 0.16, 0.148, 0.141, 0.136, 0.13, 0.126, 0.123, 0.121, 0.122, 0.119, 0.114, 0.115, 0.117, 0.117,
    0.118, 0.12, 0.122, 0.128, 0.132, 0.139, 0.144, 0.146, 0.15, 0.152, 0.157, 0.159,
};
constexpr double kcornell_light[] = {
    0.78, 0.78, 0.78, 0.78,
};
constexpr double kmacbeth_1[] = {
    0.055, 0.058, 0.061, 0.062, 0.062, 0.062, 0.062, 0.062, 0.062, 0.062, 0.062, 0.063, 0.065, 0.07, 0.076, 0.079,
    0.081, 0.084, 0.091, 0.103, 0.119, 0.134, 0.143, 0.147, 0.151, 0.158, 0.168, 0.179, 0.188, 0.19, 0.186, 0.181,
    0.182, 0.187, 0.196, 0.209,
};
constexpr double kmacbeth_2[] = {
    0.117, 0.143, 0.175, 0.191, 0.196, 0.199, 0.204, 0.213, 0.228, 0.251, 0.28, 0.309, 0.329, 0.333, 0.315, 0.286,
    0.273, 0.276, 0.277, 0.289, 0.339, 0.42, 0.488, 0.525, 0.546, 0.562, 0.578, 0.595, 0.612, 0.625, 0.638, 0.656,
    0.678, 0.7, 0.717, 0.734,
};
constexpr double kmacbeth_3[] = {
    0.13, 0.177, 0.251, 0.306, 0.324, 0.33, 0.333, 0.331, 0.323, 0.311, 0.298, 0.285, 0.269, 0.25, 0.231, 0.214,
    0.199, 0.185, 0.169, 0.157, 0.149, 0.145, 0.142, 0.141, 0.141, 0.141, 0.143, 0.147, 0.152, 0.154, 0.15, 0.144,
    0.136, 0.132, 0.135, 0.147,
};
constexpr double kmacbeth_4[] = {
    0.051, 0.054, 0.056, 0.057, 0.058, 0.059, 0.06, 0.061, 0.062, 0.063, 0.065, 0.067, 0.075, 0.101, 0.145, 0.178,
    0.184, 0.17, 0.149, 0.133, 0.122, 0.115, 0.109, 0.105, 0.104, 0.106, 0.109, 0.112, 0.114, 0.114, 0.112, 0.112,
    0.115, 0.12, 0.125, 0.13,
};
constexpr double kmacbeth_5[] = {
    0.144, 0.198, 0.294, 0.375, 0.408, 0.421, 0.426, 0.426, 0.419, 0.403, 0.379, 0.346, 0.311, 0.281, 0.254, 0.229,
    0.214, 0.208, 0.202, 0.194, 0.193, 0.2, 0.214, 0.23, 0.241, 0.254, 0.279, 0.313, 0.348, 0.366, 0.366, 0.359,
    0.358, 0.365, 0.377, 0.398,
};
constexpr double kmacbeth_6[] = {
    0.136, 0.179, 0.247, 0.297, 0.32, 0.337, 0.355, 0.381, 0.419, 0.466, 0.51, 0.546, 0.567, 0.574, 0.569, 0.551,
    0.524, 0.488, 0.445, 0.4, 0.35, 0.299, 0.252, 0.221, 0.204, 0.196, 0.191, 0.188, 0.191, 0.199, 0.212, 0.223,
    0.232, 0.233, 0.229, 0.229,
};
constexpr double kmacbeth_7[] = {
    0.054, 0.054, 0.053, 0.054, 0.054, 0.055, 0.055, 0.055, 0.056, 0.057, 0.058, 0.061, 0.068, 0.089, 0.125, 0.154,
    0.174, 0.199, 0.248, 0.335, 0.444, 0.538, 0.587, 0.595, 0.591, 0.587, 0.584, 0.584, 0.59, 0.603, 0.62, 0.639,
    0.655, 0.663, 0.663, 0.667,
};
constexpr double kmacbeth_8[] = {
    0.122, 0.164, 0.229, 0.286, 0.327, 0.361, 0.388, 0.4, 0.392, 0.362, 0.316, 0.26, 0.209, 0.168, 0.138, 0.117,
    0.104, 0.096, 0.09, 0.086, 0.084, 0.084, 0.084, 0.084, 0.084, 0.085, 0.09, 0.098, 0.109, 0.123, 0.143, 0.169,
    0.205, 0.244, 0.287, 0.332,
};
constexpr double kmacbeth_9[] = {
    0.096, 0.115, 0.131, 0.135, 0.133, 0.132, 0.13, 0.128, 0.125, 0.12, 0.115, 0.11, 0.105, 0.1, 0.095, 0.093, 0.092,
    0.093, 0.096, 0.108, 0.156, 0.265, 0.399, 0.5, 0.556, 0.579, 0.588, 0.591, 0.593, 0.594, 0.598, 0.602, 0.607,
    0.609, 0.609, 0.61,
};
constexpr double kmacbeth_10[] = {
    0.092, 0.116, 0.146, 0.169, 0.178, 0.173, 0.158, 0.139, 0.119, 0.101, 0.087, 0.075, 0.066, 0.06, 0.056, 0.053,
    0.051, 0.051, 0.052, 0.052, 0.051, 0.052, 0.058, 0.073, 0.096, 0.119, 0.141, 0.166, 0.194, 0.227, 0.265, 0.309,
    0.355, 0.396, 0.436, 0.478,
};
constexpr double kmacbeth_11[] = {
    0.061, 0.061, 0.062, 0.063, 0.064, 0.066, 0.069, 0.075, 0.085, 0.105, 0.139, 0.192, 0.271, 0.376, 0.476, 0.531,
    0.549, 0.546, 0.528, 0.504, 0.471, 0.428, 0.381, 0.347, 0.327, 0.318, 0.312, 0.31, 0.314, 0.327, 0.345, 0.363,
    0.376, 0.381, 0.378, 0.379,
};
constexpr double kmacbeth_12[] = {
    0.063, 0.063, 0.063, 0.064, 0.064, 0.064, 0.065, 0.066, 0.067, 0.068, 0.071, 0.076, 0.087, 0.125, 0.206, 0.305,
    0.383, 0.431, 0.469, 0.518, 0.568, 0.607, 0.628, 0.637, 0.64, 0.642, 0.645, 0.648, 0.651, 0.653, 0.657, 0.664,
    0.673, 0.68, 0.684, 0.688,
};
constexpr double kmacbeth_13[] = {
    0.066, 0.079, 0.102, 0.146, 0.2, 0.244, 0.282, 0.309, 0.308, 0.278, 0.231, 0.178, 0.13, 0.094, 0.07, 0.054, 0.046,
    0.042, 0.039, 0.038, 0.038, 0.038, 0.038, 0.039, 0.039, 0.04, 0.041, 0.042, 0.044, 0.045, 0.046, 0.046, 0.048,
    0.052, 0.057, 0.065,
};
constexpr double kmacbeth_14[] = {
    0.052, 0.053, 0.054, 0.055, 0.057, 0.059, 0.061, 0.066, 0.075, 0.093, 0.125, 0.178, 0.246, 0.307, 0.337, 0.334,
    0.317, 0.293, 0.262, 0.23, 0.198, 0.165, 0.135, 0.115, 0.104, 0.098, 0.094, 0.092, 0.093, 0.097, 0.102, 0.108,
    0.113, 0.115, 0.114, 0.114,
};
constexpr double kmacbeth_15[] = {
    0.05, 0.049, 0.048, 0.047, 0.047, 0.047, 0.047, 0.047, 0.046, 0.045, 0.044, 0.044, 0.045, 0.046, 0.047, 0.048,
    0.049, 0.05, 0.054, 0.06, 0.072, 0.104, 0.178, 0.312, 0.467, 0.581, 0.644, 0.675, 0.69, 0.698, 0.706, 0.715,
    0.724, 0.73, 0.734, 0.738,
};
constexpr double kmacbeth_16[] = {
    0.058, 0.054, 0.052, 0.052, 0.053, 0.054, 0.056, 0.059, 0.067, 0.081, 0.107, 0.152, 0.225, 0.336, 0.462, 0.559,
    0.616, 0.65, 0.672, 0.694, 0.71, 0.723, 0.731, 0.739, 0.746, 0.752, 0.758, 0.764, 0.769, 0.771, 0.776, 0.782,
    0.79, 0.796, 0.799, 0.804,
};
constexpr double kmacbeth_17[] = {
    0.145, 0.195, 0.283, 0.346, 0.362, 0.354, 0.334, 0.306, 0.276, 0.248, 0.218, 0.19, 0.168, 0.149, 0.127, 0.107,
    0.1, 0.102, 0.104, 0.109, 0.137, 0.2, 0.29, 0.4, 0.516, 0.615, 0.687, 0.732, 0.76, 0.774, 0.783, 0.793, 0.803,
    0.812, 0.817, 0.825,
};
constexpr double kmacbeth_18[] = {
    0.108, 0.141, 0.192, 0.236, 0.261, 0.286, 0.317, 0.353, 0.39, 0.426, 0.446, 0.444, 0.423, 0.385, 0.337, 0.283,
    0.231, 0.185, 0.146, 0.118, 0.101, 0.09, 0.082, 0.076, 0.074, 0.073, 0.073, 0.074, 0.076, 0.077, 0.076, 0.075,
    0.073, 0.072, 0.074, 0.079,
};
constexpr double kmacbeth_19[] = {
    0.189, 0.255, 0.423, 0.66, 0.811, 0.862, 0.877, 0.884, 0.891, 0.896, 0.899, 0.904, 0.907, 0.909, 0.911, 0.91,
    0.911, 0.914, 0.913, 0.916, 0.915, 0.916, 0.914, 0.915, 0.918, 0.919, 0.921, 0.923, 0.924, 0.922, 0.922, 0.925,
    0.927, 0.93, 0.93, 0.933,
};
constexpr double kmacbeth_20[] = {
    0.171, 0.232, 0.365, 0.507, 0.567, 0.583, 0.588, 0.59, 0.591, 0.59, 0.588, 0.588, 0.589, 0.589, 0.591, 0.59, 0.59,
    0.59, 0.589, 0.591, 0.59, 0.59, 0.587, 0.585, 0.583, 0.58, 0.578, 0.576, 0.574, 0.572, 0.571, 0.569, 0.568, 0.568,
    0.566, 0.566,
};
constexpr double kmacbeth_21[] = {
    0.144, 0.192, 0.272, 0.331, 0.35, 0.357, 0.361, 0.363, 0.363, 0.361, 0.359, 0.358, 0.358, 0.359, 0.36, 0.36,
    0.361, 0.361, 0.36, 0.362, 0.362, 0.361, 0.359, 0.358, 0.355, 0.352, 0.35, 0.348, 0.345, 0.343, 0.34, 0.338,
    0.335, 0.334, 0.332, 0.331,
};
constexpr double kmacbeth_22[] = {
    0.105, 0.131, 0.163, 0.18, 0.186, 0.19, 0.193, 0.194, 0.194, 0.192, 0.191, 0.191, 0.191, 0.192, 0.192, 0.192,
    0.192, 0.192, 0.192, 0.193, 0.192, 0.192, 0.191, 0.189, 0.188, 0.186, 0.184, 0.182, 0.181, 0.179, 0.178, 0.176,
    0.174, 0.173, 0.172, 0.171,
};
constexpr double kmacbeth_23[] = {
    0.068, 0.077, 0.084, 0.087, 0.089, 0.09, 0.092, 0.092, 0.091, 0.09, 0.09, 0.09, 0.09, 0.09, 0.09, 0.09, 0.09,
    0.09, 0.09, 0.09, 0.09, 0.089, 0.089, 0.088, 0.087, 0.086, 0.086, 0.085, 0.084, 0.084, 0.083, 0.083, 0.082, 0.081,
    0.081, 0.081,
};
constexpr double kmacbeth_24[] = {
    0.031, 0.032, 0.032, 0.033, 0.033, 0.033, 0.033, 0.033, 0.032, 0.032, 0.032, 0.032, 0.032, 0.032, 0.032, 0.032,
    0.032, 0.032, 0.032, 0.032, 0.032, 0.032, 0.032, 0.032, 0.032, 0.032, 0.032, 0.032, 0.032, 0.032, 0.032, 0.032,
    0.032, 0.032, 0.032, 0.033,
};

constexpr NamedSpectrum kReflectances[] = {
    {"cornell-white",
     "Cornell box measured data, Cornell University Program of Computer Graphics",
     400, 4, kcornell_white},
    {"cornell-red",
     "Cornell box measured data, Cornell University Program of Computer Graphics",
     400, 4, kcornell_red},
    {"cornell-green",
     "Cornell box measured data, Cornell University Program of Computer Graphics",
     400, 4, kcornell_green},
    {"cornell-light",
     "Cornell box measured data (reflectance of the lamp housing), Cornell University Program of Computer Graphics",
     400, 100, kcornell_light},
    {"macbeth-1",
     "BabelColor ColorChecker, average of 30 charts (D. Pascale), as tabulated by colour-science (BSD-3-Clause)",
     380, 10, kmacbeth_1},
    {"macbeth-2",
     "BabelColor ColorChecker, average of 30 charts (D. Pascale), as tabulated by colour-science (BSD-3-Clause)",
     380, 10, kmacbeth_2},
    {"macbeth-3",
     "BabelColor ColorChecker, average of 30 charts (D. Pascale), as tabulated by colour-science (BSD-3-Clause)",
     380, 10, kmacbeth_3},
    {"macbeth-4",
     "BabelColor ColorChecker, average of 30 charts (D. Pascale), as tabulated by colour-science (BSD-3-Clause)",
     380, 10, kmacbeth_4},
    {"macbeth-5",
     "BabelColor ColorChecker, average of 30 charts (D. Pascale), as tabulated by colour-science (BSD-3-Clause)",
     380, 10, kmacbeth_5},
    {"macbeth-6",
     "BabelColor ColorChecker, average of 30 charts (D. Pascale), as tabulated by colour-science (BSD-3-Clause)",
     380, 10, kmacbeth_6},
    {"macbeth-7",
     "BabelColor ColorChecker, average of 30 charts (D. Pascale), as tabulated by colour-science (BSD-3-Clause)",
     380, 10, kmacbeth_7},
    {"macbeth-8",
     "BabelColor ColorChecker, average of 30 charts (D. Pascale), as tabulated by colour-science (BSD-3-Clause)",
     380, 10, kmacbeth_8},
    {"macbeth-9",
     "BabelColor ColorChecker, average of 30 charts (D. Pascale), as tabulated by colour-science (BSD-3-Clause)",
     380, 10, kmacbeth_9},
    {"macbeth-10",
     "BabelColor ColorChecker, average of 30 charts (D. Pascale), as tabulated by colour-science (BSD-3-Clause)",
     380, 10, kmacbeth_10},
    {"macbeth-11",
     "BabelColor ColorChecker, average of 30 charts (D. Pascale), as tabulated by colour-science (BSD-3-Clause)",
     380, 10, kmacbeth_11},
    {"macbeth-12",
     "BabelColor ColorChecker, average of 30 charts (D. Pascale), as tabulated by colour-science (BSD-3-Clause)",
     380, 10, kmacbeth_12},
    {"macbeth-13",
     "BabelColor ColorChecker, average of 30 charts (D. Pascale), as tabulated by colour-science (BSD-3-Clause)",
     380, 10, kmacbeth_13},
    {"macbeth-14",
     "BabelColor ColorChecker, average of 30 charts (D. Pascale), as tabulated by colour-science (BSD-3-Clause)",
     380, 10, kmacbeth_14},
    {"macbeth-15",
     "BabelColor ColorChecker, average of 30 charts (D. Pascale), as tabulated by colour-science (BSD-3-Clause)",
     380, 10, kmacbeth_15},
    {"macbeth-16",
     "BabelColor ColorChecker, average of 30 charts (D. Pascale), as tabulated by colour-science (BSD-3-Clause)",
     380, 10, kmacbeth_16},
    {"macbeth-17",
     "BabelColor ColorChecker, average of 30 charts (D. Pascale), as tabulated by colour-science (BSD-3-Clause)",
     380, 10, kmacbeth_17},
    {"macbeth-18",
     "BabelColor ColorChecker, average of 30 charts (D. Pascale), as tabulated by colour-science (BSD-3-Clause)",
     380, 10, kmacbeth_18},
    {"macbeth-19",
     "BabelColor ColorChecker, average of 30 charts (D. Pascale), as tabulated by colour-science (BSD-3-Clause)",
     380, 10, kmacbeth_19},
    {"macbeth-20",
     "BabelColor ColorChecker, average of 30 charts (D. Pascale), as tabulated by colour-science (BSD-3-Clause)",
     380, 10, kmacbeth_20},
    {"macbeth-21",
     "BabelColor ColorChecker, average of 30 charts (D. Pascale), as tabulated by colour-science (BSD-3-Clause)",
     380, 10, kmacbeth_21},
    {"macbeth-22",
     "BabelColor ColorChecker, average of 30 charts (D. Pascale), as tabulated by colour-science (BSD-3-Clause)",
     380, 10, kmacbeth_22},
    {"macbeth-23",
     "BabelColor ColorChecker, average of 30 charts (D. Pascale), as tabulated by colour-science (BSD-3-Clause)",
     380, 10, kmacbeth_23},
    {"macbeth-24",
     "BabelColor ColorChecker, average of 30 charts (D. Pascale), as tabulated by colour-science (BSD-3-Clause)",
     380, 10, kmacbeth_24},
};

} // namespace

std::span<const NamedSpectrum> reflectances() { return kReflectances; }

} // namespace abbe::data
