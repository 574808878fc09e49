"""Reads the pages of `laves report`: their elements, facts and blocks of numbers, with nothing but Python's own library."""
import array
import base64
import html.parser
import json
import zlib


class _Elements(html.parser.HTMLParser):
    """Scripts by their id, every address that the page names, and the text of its styles."""

    def __init__(self):
        super().__init__(convert_charrefs=True)
        self.scripts, self.addresses, self.tags, self.styles, self.policy = {}, [], [], "", ""
        self._in = None

    def handle_starttag(self, tag, attributes):
        named = dict(attributes)
        self.tags.append(tag)
        self.addresses += [value for key, value in attributes if key in ("src", "href", "action", "srcset", "data", "poster")]
        if tag == "meta" and named.get("http-equiv") == "Content-Security-Policy":
            self.policy = named["content"]
        if tag in ("script", "style"):
            self._in = (tag, named.get("id", "main"))
            if tag == "script":
                assert self._in[1] not in self.scripts, f"two scripts {self._in[1]}"
                self.scripts[self._in[1]] = ""

    def handle_endtag(self, tag):
        if self._in and tag == self._in[0]:
            self._in = None

    def handle_data(self, text):
        if self._in and self._in[0] == "script":
            self.scripts[self._in[1]] += text
        elif self._in:
            self.styles += text


class Block:
    """The arrays of a block, in the order in which they were written."""

    def __init__(self, text):
        self.data, self.at = zlib.decompress(base64.b64decode(text, validate=True)), 0

    def _take(self, count):
        self.at += count
        assert self.at <= len(self.data), "a block is too short"
        return self.data[self.at - count:self.at]

    def done(self):
        assert self.at == len(self.data), "a block is too long"

    def bytes(self, count):
        return list(self._take(count))

    def _planes(self, count, width):
        data, whole = self._take(width * count), bytearray(width * count)
        for plane in range(width):
            whole[plane::width] = data[plane * count:(plane + 1) * count]
        return bytes(whole)

    def shorts(self, count):
        return list(array.array("H", self._planes(count, 2)))

    def floats(self, count):
        return list(array.array("f", self._planes(count, 4)))

    def indices(self, count):
        out, before = [], 0
        for word in array.array("I", self._planes(count, 4)):
            before = (before + (word >> 1 ^ -(word & 1))) % 2**32
            out.append(before)
        return out


class Page:
    def __init__(self, path):
        with open(path, encoding="utf-8") as file:
            self.text = file.read()
        self.elements = _Elements()
        self.elements.feed(self.text)
        self.elements.close()
        self.facts = json.loads(self.elements.scripts["facts"])

    def has(self, name):
        return name in self.elements.scripts

    def block(self, name):
        return Block(self.elements.scripts[name])

    def columns(self, name, width, kind, count):
        block = self.block(name)
        columns = [getattr(block, kind)(count) for _ in range(width)]
        block.done()
        return list(zip(*columns)) if width > 1 else columns[0]

    def points(self):
        return self.columns("points", 3, "floats", self.facts["embedded"]["vertices"])

    def tets(self):
        return self.columns("tets", 4, "indices", self.facts["embedded"]["tets"])

    def section(self, axis, cut):
        """The faces that lie open: (corners' places, number below, number above) each, and the classes below."""
        block, embedded = self.block(f"section-{axis}-{cut}"), self.facts["embedded"]
        count, vertices = block.indices(2)
        steps = [block.shorts(vertices) for _ in range(3)]
        low, high = embedded["lower"], embedded["upper"]
        places = [tuple(low[k] - embedded["origin"][k] + steps[k][i] / 65535 * (high[k] - low[k]) for k in range(3)) for i in range(vertices)]
        corners = list(zip(*[block.indices(count) for _ in range(3)]))
        sides = []
        for _ in range(2):
            side = {"numbers": block.indices(count)}
            for name, start, end in (("min_dihedral", 0, 180), ("max_dihedral", 0, 180), ("radius_ratio", 0, 1), ("radius_edge", 1, 5)):
                side[name] = [start + value / 65535 * (end - start) for value in block.shorts(count)]
            side["classes"] = block.bytes(count)
            if self.has("regions"):
                side["regions"] = block.shorts(count)
            sides.append(side)
        block.done()
        return [tuple(places[c] for c in face) for face in corners], sides
