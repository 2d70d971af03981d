"""A network of the size and shape of Depth-Anything-V2-Small, with random weights: to time it.

DINOv2 ViT-S/14 (12 blocks, 384 features, 6 heads) and the DPT head with 48, 96, 192 and 384 features (Oquab
et al. 2023, arXiv:2304.07193; Ranftl et al. 2021, arXiv:2103.13413; Yang et al. 2024, arXiv:2406.09414).
"""

import torch
from torch import Tensor, nn
from torch.nn import functional as F  # noqa: N812

PATCH, WIDTH, HEADS, BLOCKS = 14, 384, 6, 12
TAPS = (2, 5, 8, 11)
LEVELS = (48, 96, 192, 384)
FUSED = 64


class Block(nn.Module):
    """Attention and a two-layer perceptron, each with layer norm before and a learned scale after."""

    def __init__(self) -> None:
        super().__init__()
        self.norms = nn.ModuleList(nn.LayerNorm(WIDTH, eps=1e-6) for _ in range(2))
        self.qkv, self.out = nn.Linear(WIDTH, 3 * WIDTH), nn.Linear(WIDTH, WIDTH)
        self.mlp = nn.Sequential(nn.Linear(WIDTH, 4 * WIDTH), nn.GELU(), nn.Linear(4 * WIDTH, WIDTH))
        self.scales = nn.ParameterList(torch.ones(WIDTH) for _ in range(2))

    def forward(self, tokens: Tensor) -> Tensor:
        """(1, n, 384) to the same."""
        count = tokens.shape[1]
        qkv = self.qkv(self.norms[0](tokens)).reshape(1, count, 3, HEADS, WIDTH // HEADS)
        query, key, value = qkv.permute(2, 0, 3, 1, 4)
        weights = (query * (WIDTH // HEADS) ** -0.5 @ key.transpose(-2, -1)).softmax(dim=-1)
        mixed = (weights @ value).transpose(1, 2).reshape(1, count, WIDTH)
        tokens = tokens + self.scales[0] * self.out(mixed)
        refined: Tensor = tokens + self.scales[1] * self.mlp(self.norms[1](tokens))
        return refined


class Residual(nn.Module):
    """Two 3x3 convolutions beside the identity."""

    def __init__(self) -> None:
        super().__init__()
        self.convolutions = nn.Sequential(
            nn.ReLU(), nn.Conv2d(FUSED, FUSED, 3, padding=1), nn.ReLU(), nn.Conv2d(FUSED, FUSED, 3, padding=1)
        )

    def forward(self, maps: Tensor) -> Tensor:
        """Same shape."""
        refined: Tensor = maps + self.convolutions(maps)
        return refined


class Fusion(nn.Module):
    """Joins a coarser path with a finer level and enlarges."""

    def __init__(self) -> None:
        super().__init__()
        self.side, self.after = Residual(), Residual()
        self.out = nn.Conv2d(FUSED, FUSED, 1)

    def forward(self, path: Tensor | None, level: Tensor, size: tuple[int, int]) -> Tensor:
        """(1, 64, size)."""
        joined = level if path is None else path + self.side(level)
        enlarged = F.interpolate(self.after(joined), size=size, mode="bilinear", align_corners=True)
        out: Tensor = self.out(enlarged)
        return out


class DepthNet(nn.Module):
    """(1, 3, H, W) normalised RGB to (1, 1, H, W) relative depth; H and W are multiples of 14."""

    def __init__(self, height: int, width: int) -> None:
        super().__init__()
        self.rows, self.columns = height // PATCH, width // PATCH
        self.patches = nn.Conv2d(3, WIDTH, PATCH, stride=PATCH)
        self.token = nn.Parameter(torch.zeros(1, 1, WIDTH))
        self.position = nn.Parameter(torch.randn(1, self.rows * self.columns + 1, WIDTH) * 0.02)
        self.blocks = nn.ModuleList(Block() for _ in range(BLOCKS))
        self.norm = nn.LayerNorm(WIDTH, eps=1e-6)
        self.project = nn.ModuleList(nn.Conv2d(WIDTH, level, 1) for level in LEVELS)
        self.resize = nn.ModuleList(
            [
                nn.ConvTranspose2d(LEVELS[0], LEVELS[0], 4, stride=4),
                nn.ConvTranspose2d(LEVELS[1], LEVELS[1], 2, stride=2),
                nn.Identity(),
                nn.Conv2d(LEVELS[3], LEVELS[3], 3, stride=2, padding=1),
            ]
        )
        self.narrow = nn.ModuleList(nn.Conv2d(level, FUSED, 3, padding=1, bias=False) for level in LEVELS)
        self.fusions = nn.ModuleList(Fusion() for _ in LEVELS)
        self.head = nn.Conv2d(FUSED, FUSED // 2, 3, padding=1)
        self.tail = nn.Sequential(
            nn.Conv2d(FUSED // 2, 32, 3, padding=1), nn.ReLU(), nn.Conv2d(32, 1, 1), nn.ReLU()
        )

    def forward(self, image: Tensor) -> Tensor:
        """Depth of one image."""
        levels = [
            narrow(resize(project(maps)))
            for maps, project, resize, narrow in zip(
                self.encode(image), self.project, self.resize, self.narrow, strict=True
            )
        ]
        path: Tensor | None = None
        for index in (3, 2, 1, 0):
            rows, columns = (int(length) for length in levels[index].shape[-2:])
            finer = levels[index - 1].shape[-2:] if index else (2 * rows, 2 * columns)
            path = self.fusions[index](path, levels[index], (int(finer[0]), int(finer[1])))
        size = (self.rows * PATCH, self.columns * PATCH)
        enlarged = F.interpolate(self.head(path), size=size, mode="bilinear", align_corners=True)
        depth: Tensor = self.tail(enlarged)
        return depth

    def encode(self, image: Tensor) -> list[Tensor]:
        """Four feature maps (1, 384, rows, columns)."""
        tokens = self.patches(image).flatten(2).transpose(1, 2)
        tokens = torch.cat([self.token, tokens], dim=1) + self.position
        taps = []
        for index, block in enumerate(self.blocks):
            tokens = block(tokens)
            if index in TAPS:
                taps.append(
                    self.norm(tokens)[:, 1:].transpose(1, 2).reshape(1, WIDTH, self.rows, self.columns)
                )
        return taps
