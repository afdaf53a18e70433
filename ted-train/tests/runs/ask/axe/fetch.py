"""Fetches axe-core, which finds what makes a page hard to use without eyes or a mouse: `axe.py FILE`.

Nothing of it is part of TED: the browser's tests load it into the pages that they look at. It comes from npm's registry, and is only kept if it is
what it was when this was written.
"""

import base64
import hashlib
import io
import os
import sys
import tarfile
import urllib.request

VERSION = "4.14.1"
ADDRESS = f"https://registry.npmjs.org/axe-core/-/axe-core-{VERSION}.tgz"
SHA512 = "FHfa+lmNjQZfJz1q8wKqIDwC6DExcHt/pkjNQb09a3NPjCKg2rhu5qb2S4r76ASyFNNtuFooJpZe37OgudVGtQ=="


def main(file):
    with urllib.request.urlopen(ADDRESS, timeout=120) as answer:
        package = answer.read()
    if base64.b64encode(hashlib.sha512(package).digest()).decode() != SHA512:
        sys.exit(f"{ADDRESS} is not the file that it was")
    with tarfile.open(fileobj=io.BytesIO(package)) as members:
        script = members.extractfile("package/axe.min.js").read()
    begun = f"{file}.{os.getpid()}"
    with open(begun, "wb") as out:
        out.write(script)
    os.replace(begun, file)


main(sys.argv[1])
