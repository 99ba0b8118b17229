// What Coin (libcoin-dev) reads from an Open Inventor file: triangles, area, signed volume, bounds.
//
//   c++ -O2 -o coin tests/peers/coin.cpp -lCoin && ./coin a.iv
//   ./coin --write ascii|gzip|binary a.iv b.iv
//   ./coin --time 5 a.iv
//
// One line for each file. Triangles are those that Coin would draw, where transforms put them. With
// --write Coin writes what it read; with --time the seconds of the processor that so many readings
// took come out, as JSON.

#include <Inventor/SbVec3d.h>
#include <Inventor/SoDB.h>
#include <Inventor/SoPrimitiveVertex.h>
#include <Inventor/SbName.h>
#include <Inventor/SoOutput.h>
#include <Inventor/actions/SoCallbackAction.h>
#include <Inventor/actions/SoWriteAction.h>
#include <Inventor/nodes/SoSeparator.h>
#include <Inventor/nodes/SoShape.h>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <ctime>

struct Sums {
    long n = 0;
    double area = 0, volume = 0, low[3] = {1e300, 1e300, 1e300}, high[3] = {-1e300, -1e300, -1e300};
};

static void triangle(void *data, SoCallbackAction *action, const SoPrimitiveVertex *a,
                     const SoPrimitiveVertex *b, const SoPrimitiveVertex *c) {
    Sums &sums = *static_cast<Sums *>(data);
    SbVec3d points[3];
    const SoPrimitiveVertex *corners[3] = {a, b, c};
    for (int k = 0; k < 3; k++) {
        SbVec3f place;
        action->getModelMatrix().multVecMatrix(corners[k]->getPoint(), place);
        points[k] = SbVec3d(place[0], place[1], place[2]);
        for (int i = 0; i < 3; i++) {
            if (place[i] < sums.low[i]) sums.low[i] = place[i];
            if (place[i] > sums.high[i]) sums.high[i] = place[i];
        }
    }
    sums.n++;
    sums.area += 0.5 * (points[1] - points[0]).cross(points[2] - points[0]).length();
    sums.volume += points[0].dot(points[1].cross(points[2])) / 6;
}

static SoSeparator *scene(const char *name) {
    SoInput in;
    return in.openFile(name) ? SoDB::readAll(&in) : nullptr;
}

static int write(const char *form, const char *from, const char *to) {
    SoSeparator *root = scene(from);
    if (!root) return 1;
    root->ref();
    SoOutput out;
    if (!strcmp(form, "gzip")) out.setCompression(SbName("GZIP"), 0.5f);
    if (!out.openFile(to)) return 1;
    out.setBinary(!strcmp(form, "binary"));
    SoWriteAction(&out).apply(root);
    out.closeFile();
    root->unref();
    return 0;
}

static int time(int n, const char *name) {
    printf("{\"cpu\": [");
    for (int i = 0; i < n; i++) {
        clock_t start = clock();
        SoSeparator *root = scene(name);
        if (!root) return 1;
        printf("%s%.6f", i ? ", " : "", double(clock() - start) / CLOCKS_PER_SEC);
        root->ref();
        root->unref();
    }
    printf("]}\n");
    return 0;
}

int main(int n, char **names) {
    SoDB::init();
    if (n == 4 && !strcmp(names[1], "--time")) return time(atoi(names[2]), names[3]);
    if (n == 5 && !strcmp(names[1], "--write")) return write(names[2], names[3], names[4]);
    for (int i = 1; i < n; i++) {
        SoSeparator *root = scene(names[i]);
        if (!root) {
            printf("%s: not read\n", names[i]);
            continue;
        }
        root->ref();
        Sums sums;
        SoCallbackAction action;
        action.addTriangleCallback(SoShape::getClassTypeId(), triangle, &sums);
        action.apply(root);
        printf("%s: %ld triangles, area %.9g, volume %.9g, from %.9g %.9g %.9g to %.9g %.9g %.9g\n",
               names[i], sums.n, sums.area, sums.volume, sums.low[0], sums.low[1], sums.low[2],
               sums.high[0], sums.high[1], sums.high[2]);
        root->unref();
    }
}
