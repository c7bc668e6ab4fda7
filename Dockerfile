# ROS 2 Jazzy from apt, and the package in a workspace: docker build -t isa_ros . && docker run isa_ros
FROM ros:jazzy-ros-base
SHELL ["/bin/bash", "-o", "pipefail", "-c"]
ENV DEBIAN_FRONTEND=noninteractive
WORKDIR /ws
COPY . src/isa_ros
# hadolint ignore=DL3008,DL3013
RUN apt-get update \
    && apt-get install --yes --no-install-recommends python3-lz4 python3-pip python3-zstandard \
    && pip install --no-cache-dir --break-system-packages mcap \
    && rosdep update --rosdistro jazzy \
    && rosdep install --from-paths src --ignore-src --rosdistro jazzy --default-yes \
        --dependency-types exec \
    && rm -rf /var/lib/apt/lists/*
RUN . /opt/ros/jazzy/setup.bash && colcon build
# The entry point of the image sources ROS; what runs here sources the workspace too.
RUN echo 'source /ws/install/setup.bash' >> /etc/bash.bashrc
CMD ["bash", "-c", ". /ws/install/setup.bash && isa demo --out /tmp/demo"]
