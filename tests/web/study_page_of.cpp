// The page of a study (JSON) without a study:  study_page_of STUDY.json PAGE.html
#include "pages/pages.h"

#include <fstream>
#include <iterator>
#include <string>

int main(int argc, char** argv) {
    if (argc != 3) return 2;
    std::ifstream in(argv[1], std::ios::binary);
    const std::string json{std::istreambuf_iterator<char>(in), {}};
    std::ofstream out(argv[2], std::ios::binary);
    out << abbe::studyPage(json);
    out.close();
    return in && out ? 0 : 1;
}
