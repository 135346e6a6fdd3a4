// A program with nothing of its own: it carries the headers that tests share (tests/CMakeLists.txt).
int main() { return 0; }
