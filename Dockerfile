# Training and evaluation on a CPU or GPU host:
#   docker build -t horizon-dl . && docker run -v "$PWD/flight:/data" horizon-dl check-data /data
FROM python:3.13-slim
WORKDIR /app
COPY pyproject.toml constraints.txt README.md LICENSE ./
COPY configs configs
COPY horizon_dl horizon_dl
RUN pip install --no-cache-dir --constraint constraints.txt '.[train,logs]'
WORKDIR /data
ENTRYPOINT ["horizon-dl"]
